// SPDX-License-Identifier: MIT
#pragma once

#include "unsaturated_consolidation.hpp"

namespace verify {

/// The unsaturated column under 10 kPa, [Zhan] Figs. 6 and 7, against coupled finite volumes with
/// the same laws; times are T_v of [Zhan] Eqs. (28) and (29) with k at S = 0.86.
struct FigureConsolidation : UnsaturatedConsolidation {
  static constexpr const char* name = "consolidation of figures 6 and 7";

  explicit FigureConsolidation(Real modulus = table1::young_modulus, bool coupled = true) {
    young_modulus = modulus;
    porosity_dependent = coupled;
    load = 1e4;
    times = {0.05, 0.1, 0.2, 0.5, 1, 2};
  }

  Real seconds(Real time_factor) const {
    const Real k = conductivity() * closed_form().conductivity;
    const Real stiff = oedometric_modulus(young_modulus, table1::poisson_ratio);
    return 0.5 * ramp() + time_factor * height * height * 9810 / (k * stiff);
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time_factor) const {
    std::vector<std::pair<Real, Real>> profile;
    run.for_cells([&](Real z, Real p) { profile.emplace_back(z, p / load); });
    std::sort(profile.begin(), profile.end());
    std::vector<Comparison> result = {history(profile, time_factor)};
    const Real half = 0.5 * run.loaded.state().grid.cell_size();
    const Comparison cells = isochrone(profile, half, time_factor);
    if (!cells.values.empty()) result.push_back(cells);
    return result;
  }

 private:
  using Curve = std::vector<std::pair<Real, Real>>;

  const char* mode() const { return porosity_dependent ? "full" : "frozen"; }
  bool is_mine(const Table& table, std::size_t row) const {
    return table.text(row, "mode") == mode() && table.number(row, "E_MPa") == young_modulus * 1e-6;
  }
  /// Fig. 7.
  Comparison history(const Curve& profile, Real time_factor) const {
    static const Table table("r2_fig7_history.csv");
    Curve exact;
    for (std::size_t i = 0; i < table.size(); ++i)
      if (is_mine(table, i))
        exact.emplace_back(table.number(i, "Tv"), table.number(i, "dp_over_q_z0.25"));
    Comparison result{"pressure at 0.25 m", time_factor};
    result.add(0.25, linear(profile, 0.25), linear(exact, time_factor));
    return result;
  }
  /// Fig. 6, means over the cells; empty at times that the table has not.
  Comparison isochrone(const Curve& profile, Real half, Real time_factor) const {
    static const Table table("r2_isochrones.csv");
    Comparison result{"pressure", time_factor};
    for (const auto& [z, p] : profile) {
      Norm exact;
      for (std::size_t i = 0; i < table.size(); ++i)
        if (is_mine(table, i) && table.number(i, "Tv") == time_factor &&
            std::fabs(table.number(i, "z_m") - z) < half)
          exact.add(table.number(i, "dp_over_q"));
      if (exact.count > 0) result.add(z, p, exact.mean());
    }
    return result;
  }
};

}  // namespace verify
