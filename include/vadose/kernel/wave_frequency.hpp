// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Highest frequency of the waves in a cell: soil, pore water, both.

#include <vadose/kernel/state.hpp>

namespace vadose::kernel {

/// Highest frequency squared of soil with pore water, drag taken implicitly [1/s2]:
/// omega^2 = (2/h^2) [tr + sqrt(tr^2 - 4 det)], K* = S/(S/K + S_p),
/// tr = K*/rho_l + [E_c + S (1-n)^2 K*/n] / ((1-n) rho_s), det = K* E_c / ((1-n) rho_s rho_l).
/// E_c [Pa], K* [Pa] effective_modulus, n, S [-], densities [kg/m3], h [m].
inline Real two_phase_frequency2(Real p_wave_modulus, Real effective_modulus, Real porosity,
                                 Real saturation, Real solid_density, Real liquid_density,
                                 Real cell_size) noexcept {
  const Real solid = (1 - porosity) * solid_density;
  const Real tr = effective_modulus / liquid_density +
                  (p_wave_modulus +
                   saturation * (1 - porosity) * (1 - porosity) * effective_modulus / porosity) /
                      solid;
  const Real det = effective_modulus * p_wave_modulus / (solid * liquid_density);
  return 2 / (cell_size * cell_size) * (tr + std::sqrt(max(0.0, tr * tr - 4 * det)));
}

/// The same of a rigid skeleton: only the water moves.
inline Real seepage_frequency2(Real effective_modulus, Real liquid_density,
                               Real cell_size) noexcept {
  return 4 * effective_modulus / (liquid_density * cell_size * cell_size);
}

/// Part of 2/omega that a cell cut by the ground surface allows: its nodes carry less mass than the
/// formula assumes. Measured: 200 steps from noise on a saturated block at K = 2.2 GPa in 80
/// positions on the grid do not grow at half of this.
inline constexpr Real cut_cell_step = 0.55;

/// Part of 2/omega that a cell allows [-].
template <int Dim>
Real step_share(const Cell<Dim>& c) noexcept {
  return c.at_air && (c.members > 1 || c.raw_fill < 0.95) ? cut_cell_step : 1;
}

/// Highest frequency squared of a soil cell of effective modulus K* [Pa] and saturation S [-], over the
/// square of the part of 2/omega that it allows.
template <class M>
Real cell_frequency2(const State<M>& state, const Cell<State<M>::dim>& c, Real modulus,
                     Real saturation) noexcept {
  const Real h = state.grid.cell_size();
  const Real rho = state.water.density;
  const auto& soil = state.soils[c.material];
  const Real w2 = is_rigid<M>
                      ? seepage_frequency2(modulus, rho, h)
                      : two_phase_frequency2(soil.p_wave_modulus, modulus, c.porosity, saturation,
                                             soil.material.solid_density, rho, h);
  const Real share = step_share(c);
  return w2 / (share * share);
}

}  // namespace vadose::kernel
