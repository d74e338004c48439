// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/core/monotone_table.hpp>
#include <vadose/policy/conductivity/kozeny_carman.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::conductivity {

/// Measured relative conductivity: (S_e, k_r) pairs joined by a monotone cubic in S_e, over the
/// saturated conductivity of Kozeny and Carman. Called lane by lane.
class Table {
 public:
  /// One measurement.
  struct Entry {
    Real effective_saturation = unset;  ///< [-], [0, 1]
    Real relative = unset;              ///< k_r [-], (0, 1]
  };
  /// The saturated conductivity.
  struct Saturated {
    Real saturated_conductivity = unset;  ///< k_sat at reference_porosity [m/s], > 0
    Real reference_porosity = unset;      ///< [-], (0, 1)
    bool porosity_dependent = true;       ///< true: Kozeny-Carman; false: k_sat at any porosity
  };

  /// An empty table; validate() refuses it.
  Table() = default;

  /// At least two entries, S_e strictly increasing to 1, k_r never decreasing to 1 and positive.
  /// Throws SetupError naming the entry.
  Table(const Saturated& saturated_part, const std::vector<Entry>& entries)
      : saturated_(saturated_part) {
    std::vector<Real> x;
    std::vector<Real> y;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      check::in_context("conductivity table, entry " + std::to_string(i + 1), [&] {
        check::within("effective_saturation", entries[i].effective_saturation, 0, 1, "-");
        if (!(entries[i].relative > 0 && entries[i].relative <= 1))
          check::fail("relative", entries[i].relative, "(0, 1]", "-");
      });
      x.push_back(entries[i].effective_saturation);
      y.push_back(entries[i].relative);
    }
    if (!x.empty() && (x.back() != 1 || y.back() != 1))
      throw SetupError("conductivity table: entry " + std::to_string(x.size()) +
                       ": the last entry must be (1, 1)");
    table_ = MonotoneTable("conductivity table", std::move(x), std::move(y));
  }

  /// Takes the reference porosity from the material where unset.
  void adopt(const SharedParameters& shared) noexcept {
    detail::fill(saturated_.reference_porosity, shared.reference_porosity);
  }

  void validate() const {
    detail::check_saturated_conductivity(saturated_.porosity_dependent,
                                         saturated_.saturated_conductivity,
                                         saturated_.reference_porosity);
    if (table_.empty()) throw SetupError("conductivity table: no entries");
  }

  /// k_sat(n) [m/s].
  Real saturated(Real porosity) const {
    return detail::saturated_conductivity<Real>(saturated_.porosity_dependent,
                                                saturated_.saturated_conductivity,
                                                saturated_.reference_porosity, porosity);
  }
  /// k_r [-]; that of the first entry below it.
  Real relative(Real effective_saturation) const { return table_.at(effective_saturation).value; }
  /// k(S_e, n) [m/s].
  Real conductivity(Real effective_saturation, Real porosity) const {
    return saturated(porosity) * relative(effective_saturation);
  }

 private:
  MonotoneTable table_;
  Saturated saturated_;
};

static_assert(FactorisingConductivity<Table>);

}  // namespace vadose::conductivity
