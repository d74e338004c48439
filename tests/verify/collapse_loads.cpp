// SPDX-License-Identifier: MIT
// What soil can just carry: a slope that stands by suction, a strip load on clay.

#include "cases/footing.hpp"
#include "cases/slope_with_suction.hpp"
#include "check_case.hpp"

namespace {

using verify::Real;

/// Runs a case whose one value is a way; the ways at its times.
template <class Case>
std::vector<Real> ways(const Case& problem, int cells) {
  const auto outcome = verify::run(problem, {.cells = cells});
  verify::check_outcome(problem, outcome);
  std::vector<Real> result;
  for (const auto& c : outcome.comparisons) result.push_back(c.values.front().computed);
  return result;
}

}  // namespace

TEST_CASE("slope of 45 degrees: critical suction within 3 %") {
  const auto stands = ways(verify::SlopeWithSuction{.suction_ratio = 1.03}, 6);
  const auto slides = ways(verify::SlopeWithSuction{.suction_ratio = 0.97}, 6);
  CHECK(stands.at(1) - stands.at(0) <= 1e-3);
  CHECK(slides.at(1) - slides.at(0) >= 0.03);
}

TEST_CASE("strip load on clay: Prandtl's load within 5 %") {
  // 95 % of it until 2.5 s, 105 % from 3 s on.
  const auto settlement = ways(verify::Footing{}, 4);
  CHECK(settlement.at(1) - settlement.at(0) <= 1e-3);
  CHECK(settlement.at(3) - settlement.at(2) >= 0.03);
}
