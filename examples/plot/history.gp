# SPDX-License-Identifier: MIT
# Histories of a run of sand_slope:  gnuplot -c history.gp FOLDER
# What slope.py draws of the .csv files, where there is no matplotlib.
folder = ARGC > 0 ? ARG1 : "."
gauges = folder."/slope_gauges.csv"
front = folder."/slope_run_out.csv"
balance = folder."/slope_balance.csv"
set datafile separator ","
set terminal pngcairo size 880,990 font ",12"
set output folder."/slope_history.png"
set key left top samplen 2
set grid
set multiplot layout 3,1
set ylabel "displacement [mm]"
ux = "crest.displacement_x [m]"
uy = "crest.displacement_y [m]"
stats front using "front_99_percent [m]" every ::0::0 nooutput
start = STATS_min
plot gauges using "time [s]":(1e3 * sqrt(column(ux)**2 + column(uy)**2)) with lines lw 2 title "crest", \
     front using "time [s]":(1e3 * (column("front_99_percent [m]") - start)) with lines lw 2 \
       title "front (99 % of the slope behind it)"
set ylabel "liquid pressure [kPa]"
plot for [depth in "30 70 110 150"] gauges \
       using "time [s]":(1e-3 * column("depth_".depth."mm.liquid_pressure [Pa]")) \
       with lines lw 2 title depth." mm deep"
set ylabel "water [kg per m]"
set xlabel "time since the rain started [s]"
plot balance using "time [s]":"water_inflow [kg]" with lines lw 2 title "inflow", \
     balance using "time [s]":"water_outflow [kg]" with lines lw 2 title "outflow", \
     balance using "time [s]":"pore_water [kg]" with lines lw 2 title "stored"
unset multiplot
