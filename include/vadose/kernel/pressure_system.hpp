// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What an implicit solution for the cell pressures works on: the answer of every node to forces, the
/// unknowns, the matrix. Empty in explicit runs.

#include <cstdint>
#include <vector>

#include <vadose/core/sparse_rows.hpp>
#include <vadose/kernel/skeleton_system.hpp>
#include <vadose/kernel/step_limit.hpp>

namespace vadose {

/// Where a step without implicit pressures takes a node, and how its velocities answer to forces.
template <int Dim>
struct NodeResponse {
  Real liquid[Dim] = {}, solid[Dim] = {};                ///< predicted velocities [m/s]
  Real liquid_before[Dim] = {}, solid_before[Dim] = {};  ///< before the step [m/s]
  Real porosity = 1;                                     ///< of the control volume [-]
  Real liquid_part = 0;                                  ///< phi: f_l = phi G [-]
  Real bishop_part = 0;  ///< f_s = bishop_part G_S - pore_part G [-]
  Real pore_part[Dim] = {};
  /// Velocity per force along an axis [m/(s N)]: liquid by its own force, liquid by the solid's (and
  /// the other way round), solid by its own.
  Real liquid_liquid[Dim] = {}, liquid_solid[Dim] = {}, solid_solid[Dim] = {};
  Real normal[Dim] = {};    ///< unit normal along which the phases are tied; zero: not
  Real liquid_share = 0;    ///< what the liquid takes of the relative velocity that a tie removes
  Real gradient[Dim] = {};  ///< sum f V_c grad N [m2]
  int references = 0;       ///< cells around with a reference pressure that acts
  std::uint8_t liquid_held = 0, solid_held = 0;  ///< bit per axis: velocity is given
  bool follows = false;                          ///< no water: the liquid's velocity is the solid's
  bool grains = false;                           ///< has solid mass
  bool active = false;                           ///< has mass
};

/// A trial pressure and what it left unbalanced.
struct PressureBound {
  Real pressure = 0;  ///< [Pa]
  Real residual = 0;  ///< [m3]
  bool known = false;
};

/// Pressure unknown of the implicit solution.
template <int Dim>
struct PressureUnknown {
  static constexpr int corners = 1 << Dim;

  std::int32_t entry = -1;  ///< its cell
  Real start = 0;           ///< pressure before the step [Pa]
  Real pressure = 0;        ///< trial pressure [Pa]
  Real head = 0;            ///< pressure at the quadrature point less that at the centroid [Pa]
  Real start_quad = 0;      ///< pressure in the force before the step [Pa]
  Real weight[corners][Dim] = {};  ///< f V_c grad N of the nodes at the corners [m2]
  Real quad_change = 0;            ///< of the pressure in the force [Pa]
  Real quad_slope = 1;             ///< its derivative to the trial pressure [-]
  Real bishop_change = 0;          ///< of S p [Pa]
  Real bishop_slope = 1;           ///< its derivative [-]
  Real storage = 0;                ///< derivative of the content to the trial pressure [m3/Pa]
  Real squeeze = 0;                ///< derivative of the content to dt div v^s [m3]
  Real last_residual = 0;          ///< of the trial before this one [m3]
  PressureBound low, high;         ///< last trials that left too much water, and too little
  bool free = false;               ///< free water
  bool held = false;               ///< at the driest pressure and wants to be drier
};

/// How the solution of a step went.
struct SolveReport {
  int newton = 0;     ///< Newton iterations
  int linear = 0;     ///< iterations of the linear solver, all Newton iterations together
  int retries = 0;    ///< attempts with a larger step that were given up
  Real residual = 0;  ///< largest water volume left unbalanced in a cell over its pore volume [-]
  Real saturation_change = 0;  ///< largest change of saturation in a cell [-]
  bool skeleton = false;       ///< the motion of the skeleton was solved for too
  Real inertia = 1;  ///< factor of the inertia of the grains, 1 but in quasi-static steps [-]
  /// Of inertia in the weights and loads, in quasi-static runs; where the skeleton was solved for, of the
  /// forces that were out of balance before the step [-].
  Real inertia_share = 0;
};

/// A flux per area through the ground or a wall [m/s] and its derivatives.
struct SurfaceFlux {
  Real value = 0;
  Real head_slope = 0;   ///< to the head gradient [m/s per Pa/m]
  Real grain_slope = 0;  ///< to the mean velocity of the grains at the face [-]
};

/// Everything an implicit solution keeps. Only next_dt, next_limit and inertia_share outlive the step.
template <int Dim>
struct PressureSystem {
  static constexpr int corners = 1 << Dim;
  /// Derivatives of the balances of the cells around a node to the pressures of these cells.
  struct NodeBlock {
    Real value[corners][corners];
  };

  Real next_dt = 0;  ///< step that the control of the error allows next [s]; 0: no say yet
  StepLimit next_limit = StepLimit::accuracy;  ///< and why not more
  Real inertia_share = 0;                      ///< of the last step: see SolveReport
  Real wave_dt = 0;                            ///< step that waves in the skeleton allow [s]
  SolveReport report;
  std::vector<NodeResponse<Dim>> response;          ///< per node
  std::vector<PressureUnknown<Dim>> unknowns;       ///< in order of cells
  std::vector<std::int32_t> row_of;                 ///< unknown of a cell that owns one, else -1
  std::vector<std::int32_t> last_row_of, last_dof;  ///< that the pattern was made for
  std::vector<Real> start_gradient;                 ///< of the faces before the step [Pa/m]
  std::vector<SurfaceFlux> surface_flux;            ///< of faces of the ground and of walls
  std::vector<NodeBlock> blocks;                    ///< per node
  std::vector<Real> residual, change, worst;
  std::vector<Real> compliance;  ///< of the soil of a cell by itself, added to the matrix [m3/Pa]
  SparseRows matrix;
  SparseSolver solver;
  SkeletonSystem<Dim> skeleton;  ///< of steps longer than those of waves in it
};

}  // namespace vadose
