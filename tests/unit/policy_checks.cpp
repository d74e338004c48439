// SPDX-License-Identifier: MIT
// The checks that authors of policies run: every law and curve of the library passes, and every
// mistake is found by the check that is meant for it.

#include <doctest/doctest.h>

#include <vadose/policy/law.hpp>
#include <vadose/policy/swrc/always_saturated.hpp>
#include <vadose/policy/swrc/gardner.hpp>
#include <vadose/policy/swrc/table.hpp>
#include <vadose/policy/swrc/tarantino.hpp>
#include <vadose/policy/swrc/van_genuchten.hpp>
#include <vadose/testing/check_law.hpp>
#include <vadose/testing/check_swrc.hpp>

#include "../../examples/laws/brooks_corey.hpp"
#include "../../examples/laws/von_mises.hpp"

using namespace vadose;
using vadose::testing::check_law;
using vadose::testing::check_swrc;
using vadose::testing::LawCheckOptions;
using vadose::testing::Report;
using vadose::testing::SwrcCheckOptions;

namespace {

constexpr law::LinearElastic elastic{.young_modulus = 10e6, .poisson_ratio = 0.3};

template <class L>
void check_passes(const L& law, const LawCheckOptions& options = {}) {
  const Report report = check_law(law, options);
  INFO(report.text());
  CHECK(report.ok());
  CHECK(report.comparisons() > 1000);
}
template <class C>
void check_curve(const C& curve, const SwrcCheckOptions& options = {}) {
  curve.validate();
  const Report report = check_swrc(curve, options);
  INFO(report.text());
  CHECK(report.ok());
}

/// Linear elasticity with one mistake.
enum class Mistake { none, axes, modulus, asymmetry, drift, yield, fail, nan, lanes, plane, state };
template <Mistake What>
struct WrongLaw {
  template <class T>
  struct State {
    T work{0.0};
  };
  void validate() const {}
  Real p_wave_modulus(const State<Real>&) const noexcept {
    return (What == Mistake::modulus ? 0.9 : 1) * elastic.p_wave_modulus();
  }
  template <class T, int N>
  Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                State<T>& state) const noexcept {
    const SymTensor<T, N>& e = step.increment;
    law::LinearElastic::State<T> none;
    if (What == Mistake::nan) stress[0] = stress[0] * T(0.0) / T(0.0);
    elastic.update(step, stress, none);
    if (What == Mistake::axes) stress[0] -= T(2e5) * e[0];  // softer along x
    if (What == Mistake::asymmetry) stress.add_isotropic(T(3e5) * e[0] - T(3e5) * e[1]);
    if (What == Mistake::drift) stress.add_isotropic(T(-1.0));  // every step
    if (What == Mistake::yield) {                               // half the return
      const auto s = stress.deviator();
      using vadose::max;
      const T norm = s.norm(), excess = max(norm - T(20e3), T(0.0));
      stress -= (T(0.5) * excess / max(norm, T(1e-300))) * s;
    }
    if (What == Mistake::lanes && std::is_same_v<T, Lanes>) stress[1] += T(1e3) * e[1];
    if (What == Mistake::plane && N == 4) stress[2] += T(1e4) * e[2];
    if (What == Mistake::state) state.work += T(1.0);  // counts calls
    if constexpr (What == Mistake::fail && std::is_same_v<T, Real>)
      if (e[0] > 1e-2) return Status::failed;
    return Status::ok;
  }
};

template <Mistake What>
void check_found(const char* by) {
  const Report report = check_law(WrongLaw<What>{});
  INFO(report.text());
  CHECK(report.failed(by));
}

/// A good curve (van Genuchten's) with one mistake.
enum class Slip {
  none,
  start,
  residual,
  rises,
  sign,
  size,
  porosity,
  inverse,
  lanes,
  combined,
  nan
};
template <Slip What>
struct WrongCurve {
  swrc::VanGenuchten good{.a = 1, .lambda = 0.5, .unit_weight = 9810};
  Real residual_saturation = What == Slip::residual ? 0.3 : 0.0;
  void validate() const {}
  template <class T>
  T saturation(T s, T n) const {
    const T value = good.template saturation<T>(s, n);
    if (What == Slip::start) return T(0.9) * value;
    if (What == Slip::rises) return value + T(0.01) * value * s * T(1e-4) / (T(1.0) + s * T(1e-4));
    if (What == Slip::lanes && std::is_same_v<T, Lanes>) return value * T(1 - 1e-6);
    if (What == Slip::porosity) return value - T(0.1) * (T(1.0) - value) * value * n;
    return value;
  }
  template <class T>
  T saturation_slope(T s, T n) const {
    const T slope = good.template saturation_slope<T>(s, n);
    if (What == Slip::sign) return T(0.0) - slope;
    if (What == Slip::size) return T(1.01) * slope;
    if (What == Slip::nan) return slope * s / s;
    return slope;
  }
  Real saturation_porosity_slope(Real, Real) const { return 0; }
  Real suction(Real value, Real n) const {
    return good.suction(value, n) * (What == Slip::inverse ? 1.001 : 1);
  }
  template <class T>
  swrc::SaturationAndSlope<T> saturation_and_slope(T s, T n) const {
    return {saturation<T>(s, n),
            saturation_slope<T>(s, n) * T(What == Slip::combined ? 1.001 : 1.0)};
  }
};

template <Slip What>
void check_found(const char* by) {
  const Report report = check_swrc(WrongCurve<What>{});
  INFO(report.text());
  CHECK(report.failed(by));
}

}  // namespace

TEST_CASE("policy checks: every law of the library passes") {
  check_passes(elastic);
  check_passes(VonMises{.elastic = elastic, .undrained_strength = 20e3});
  for (const law::Cone cone : {law::Cone::plane_strain_matched, law::Cone::outer, law::Cone::inner})
    check_passes(law::DruckerPrager{.elastic = elastic,
                                    .cohesion = 5e3,
                                    .friction_angle = degrees(30),
                                    .dilation_angle = degrees(5),
                                    .tensile_strength = 2e3,
                                    .cone = cone});
  check_passes(law::MohrCoulomb{.elastic = elastic,
                                .cohesion = 5e3,
                                .friction_angle = degrees(30),
                                .dilation_angle = degrees(5),
                                .tensile_strength = 2e3});
  using Either = law::OneOf<law::LinearElastic, law::DruckerPrager>;
  check_passes(Either{law::DruckerPrager{.elastic = elastic, .friction_angle = degrees(35)}});
}

TEST_CASE("policy checks: every mistake in a law is found") {
  CHECK(check_law(WrongLaw<Mistake::none>{}).ok());
  check_found<Mistake::axes>("frame indifference");
  check_found<Mistake::modulus>("modulus bounds the stiffness");
  check_found<Mistake::asymmetry>("no energy from an elastic cycle");
  check_found<Mistake::drift>("stress is admissible");
  check_found<Mistake::yield>("stress is admissible");
  check_found<Mistake::fail>("step is accepted");
  check_found<Mistake::nan>("stress is finite");
  check_found<Mistake::lanes>("lanes agree with numbers");
  check_found<Mistake::plane>("dimensions agree");
  check_found<Mistake::state>("state stays");
}

TEST_CASE("policy checks: every retention curve of the library passes") {
  check_curve(swrc::AlwaysSaturated{});
  check_curve(
      swrc::VanGenuchten{.residual_saturation = 0.1, .a = 1, .lambda = 0.5, .unit_weight = 9810});
  check_curve(
      swrc::Tarantino{.residual_saturation = 0.05, .a = 1.2, .lambda = 0.5, .unit_weight = 9810});
  check_curve(swrc::Gardner{.residual_saturation = 0.1, .alpha = 1, .unit_weight = 9810});
  check_curve(swrc::Table({{100, 1}, {1e3, 0.9}, {1e4, 0.5}, {1e5, 0.2}, {1e6, 0.05}}));
  check_curve(BrooksCorey{.residual_saturation = 0.05, .air_entry = 3e3, .pore_index = 2});
}

TEST_CASE("policy checks: every mistake in a retention curve is found") {
  CHECK(check_swrc(WrongCurve<Slip::none>{}).ok());
  check_found<Slip::start>("limits");
  check_found<Slip::residual>("S in [S_res, 1]");
  check_found<Slip::rises>("S never rises with suction");
  check_found<Slip::sign>("slope is never positive");
  check_found<Slip::size>("slope against difference");
  check_found<Slip::porosity>("dS/dn against difference");
  check_found<Slip::inverse>("suction is the inverse");
  check_found<Slip::lanes>("lanes agree with numbers");
  check_found<Slip::combined>("S and slope together");
  check_found<Slip::nan>("slope is never positive");
}
