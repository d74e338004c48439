// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <vadose/policy/law/linear_elastic.hpp>
#include <vadose/policy/law/strength.hpp>

namespace vadose::law {

/// How the Drucker-Prager cone is matched to the Mohr-Coulomb pyramid of the same c and phi. The
/// choice matters: phi = 35 deg, psi = 0 mobilises 33 to 55 deg in plane strain.
/// With F the factor of each: q_phi = F sin(phi), k_phi = F c cos(phi).
/// DEVIATION: [Zhan] does not state the matching; the default is exact in plane strain.
enum class Cone : unsigned char {
  outer,  ///< triaxial compression: F = 6 / (sqrt(3) (3 - sin phi))
  inner,  ///< triaxial extension: F = 6 / (sqrt(3) (3 + sin phi))
  /// Failure in plane strain at phi for the psi in use, from
  /// sin(phi) = q_phi sqrt(1 - q_psi^2/3) / (1 - q_phi q_psi/3):
  /// F = sqrt(1 + sin(psi)^2/3) / (1 + sin(phi) sin(psi)/3); F = 1 for psi = 0.
  plane_strain_matched,
  inscribed,  ///< plane strain with psi = phi: F = 1 / sqrt(1 + sin(phi)^2/3)
};

namespace detail {

/// Factor F of a cone.
template <class T>
VADOSE_INLINE T cone_factor(Cone cone, const T& sin_phi, const T& sin_psi) noexcept {
  const T one(1.0), third(1.0 / 3.0);
  switch (cone) {
    case Cone::outer:
      return T(2 * std::numbers::sqrt3) / (T(3.0) - sin_phi);
    case Cone::inner:
      return T(2 * std::numbers::sqrt3) / (T(3.0) + sin_phi);
    case Cone::inscribed:
      return one / sqrt(one + sin_phi * sin_phi * third);
    case Cone::plane_strain_matched:
      break;
  }
  return sqrt(one + sin_psi * sin_psi * third) / (one + sin_phi * sin_psi * third);
}

/// Numbers of the return for one strength.
template <class T>
struct ConeNumbers {
  T slope{};       ///< q_phi [-]
  T intercept{};   ///< k_phi [Pa]
  T dilation{};    ///< q_psi [-]
  T mean_limit{};  ///< largest mean stress [Pa]: the cut-off, at most the apex
  T compliance{};  ///< 1 / (G + K q_phi q_psi) [1/Pa]
};

/// Mean stress and sqrt(J2) of a stress [Pa].
template <class T>
struct MeanShear {
  T mean{};
  T shear{};
  T cut_off{};  ///< what the cut-off took from the mean stress of the trial [Pa]
};

/// Closed-form return in the plane of mean stress and sqrt(J2): cone, then cut-off. The apex is
/// the cut-off at k_phi / q_phi: sqrt(J2) would become negative exactly where the returned mean
/// stress exceeds it, for dilation of either sign.
template <class T>
VADOSE_INLINE MeanShear<T> return_to_cone(const MeanShear<T>& trial, const ConeNumbers<T>& cone,
                                          Real bulk_modulus, Real shear_modulus) noexcept {
  const T zero(0.0);
  const T excess = trial.shear + cone.slope * trial.mean - cone.intercept;
  const T multiplier = max(excess, zero) * cone.compliance;
  const T mean = trial.mean - T(bulk_modulus) * cone.dilation * multiplier;
  const T shear = trial.shear - T(shear_modulus) * multiplier;
  const T shear_limit = max(cone.intercept - cone.slope * cone.mean_limit, zero);
  const auto is_cut = mean > cone.mean_limit;
  return {min(mean, cone.mean_limit), select(is_cut, min(trial.shear, shear_limit), shear),
          select(is_cut, trial.mean - cone.mean_limit, zero)};
}

}  // namespace detail

/// Elasto-plasticity with a Drucker-Prager cone, not associated, with a cut-off on the mean
/// stress and, optionally, a strength mobilised by plastic shear. Tension is positive:
///   f = sqrt(J2) + q_phi sigma_m - k_phi <= 0,  sigma_m <= min(tensile_strength, k_phi/q_phi),
///   g = sqrt(J2) + q_psi sigma_m,  q_psi = F(psi, psi) sin(psi), F of the chosen cone.
/// Backward Euler, closed form: cone, else both surfaces at once (their corner; the apex is the
/// corner at k_phi/q_phi). With mobilisation the strength is that at the end of the step.
struct DruckerPrager {
  LinearElastic elastic;                   ///< below the strength
  Real cohesion = 0;                       ///< c [Pa], >= 0; the peak value with mobilisation
  Real friction_angle = unset;             ///< phi [rad], in [0, pi/2)
  Real dilation_angle = 0;                 ///< psi [rad], in (-pi/2, phi]; negative contracts
  Real tensile_strength = no_cut_off;      ///< largest mean stress [Pa], >= 0
  Cone cone = Cone::plane_strain_matched;  ///< matching to Mohr-Coulomb
  Mobilisation mobilisation = {};          ///< hardening and softening; off by default

  /// Internal variables.
  template <class T>
  struct State {
    T plastic_shear_strain{0.0};  ///< accumulated, in mobilisation.measure [-]
  };

  /// State variables that files show.
  static constexpr std::array<StateOutput, 1> outputs() noexcept {
    return {{{"plastic_shear_strain", "-", 0}}};
  }

  /// Numbers derived once; its update is that of the law.
  class Prepared;
  /// See Prepared.
  Prepared prepared() const noexcept;

  /// Oedometric modulus [Pa], the elastic one.
  Real p_wave_modulus(const State<Real>& /*state*/) const noexcept {
    return elastic.p_wave_modulus();
  }

  /// Shear modulus [Pa], the elastic one.
  Real shear_modulus(const State<Real>& /*state*/) const noexcept {
    return elastic.shear_modulus();
  }

  /// Throws SetupError on the first value outside its range.
  void validate() const;

  /// Stress at the end of a step; see the class.
  template <class T, int N>
  Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                State<T>& state) const noexcept;

  /// c, phi and psi at the peak.
  Strength<Real> peak_strength() const noexcept {
    return {cohesion, friction_angle, dilation_angle};
  }
};

/// DruckerPrager with its numbers derived.
class DruckerPrager::Prepared {
 public:
  /// That of the law.
  template <class T>
  using State = DruckerPrager::State<T>;

  /// Derives the numbers.
  explicit Prepared(const DruckerPrager& law) noexcept
      : bulk_modulus_(law.elastic.bulk_modulus()),
        shear_modulus_(law.elastic.shear_modulus()),
        tensile_strength_(law.tensile_strength),
        measure_(law.mobilisation.measure == ShearMeasure::engineering ? 1
                                                                       : std::numbers::inv_sqrt3),
        path_(law.mobilisation, law.peak_strength()),
        cone_(law.cone),
        mobilised_(law.mobilisation.active()) {
    constant_ = numbers(law.cohesion, std::sin(law.friction_angle), std::cos(law.friction_angle),
                        std::sin(law.dilation_angle));
  }

  /// Numbers of the cone at the peak.
  const detail::ConeNumbers<Real>& peak() const noexcept { return constant_; }

  /// Numbers of the cone at accumulated plastic shear strain gamma.
  template <class T>
  VADOSE_INLINE detail::ConeNumbers<T> at(const T& gamma) const noexcept {
    const Strength<T> strength = path_.at(gamma);
    return numbers(strength.cohesion, detail::sine(strength.friction_angle),
                   detail::cosine(strength.friction_angle), detail::sine(strength.dilation_angle));
  }

  /// Stress at the end of a step.
  template <class T, int N>
  VADOSE_INLINE Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                              State<T>& state) const noexcept {
    T opening;
    return update(step, stress, state, opening);
  }

  /// The same; opening: volume strain beyond what the cut-off lets the soil carry [-], else 0.
  template <class T, int N>
  VADOSE_INLINE Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                              State<T>& state, T& opening) const noexcept {
    detail::add_elastic_stress(step.increment, bulk_modulus_, shear_modulus_, stress);
    const SymTensor<T, N> deviator = stress.deviator();
    const MeanShear<T> trial{stress.mean(), sqrt(T(0.5) * contract(deviator, deviator)), T(0.0)};
    MeanShear<T> end;
    Status status = Status::ok;
    if (mobilised_)
      status = return_mobilised(trial, state.plastic_shear_strain, end);
    else
      end = detail::return_to_cone(trial, broadcast<T>(constant_), bulk_modulus_, shear_modulus_);
    const T shed = trial.shear - end.shear;
    const T part = shed / max(trial.shear, T(std::numeric_limits<Real>::min()));
    stress -= part * deviator;
    stress.add_isotropic(end.mean - trial.mean);
    opening = T(1 / bulk_modulus_) * end.cut_off;
    state.plastic_shear_strain += T(measure_ / shear_modulus_) * shed;
    return status;
  }

 private:
  template <class T>
  using MeanShear = detail::MeanShear<T>;

  template <class T>
  VADOSE_INLINE detail::ConeNumbers<T> numbers(const T& c, const T& sin_phi, const T& cos_phi,
                                               const T& sin_psi) const noexcept {
    const T factor = detail::cone_factor(cone_, sin_phi, sin_psi);
    const T slope = factor * sin_phi;
    const T intercept = factor * c * cos_phi;
    const T dilation = detail::cone_factor(cone_, sin_psi, sin_psi) * sin_psi;
    const T apex = intercept / max(slope, T(1e-30));
    return {slope, intercept, dilation, min(T(tensile_strength_), apex),
            T(1.0) / (T(shear_modulus_) + T(bulk_modulus_) * slope * dilation)};
  }

  template <class T>
  VADOSE_INLINE static detail::ConeNumbers<T> broadcast(
      const detail::ConeNumbers<Real>& one) noexcept {
    return {T(one.slope), T(one.intercept), T(one.dilation), T(one.mean_limit), T(one.compliance)};
  }

  /// Return with the strength at the end of the step. The plastic shear x of the step solves
  /// x = (sqrt(J2)_trial - sqrt(J2)(x)) / G, whose root lies in [0, sqrt(J2)_trial / G]; secant
  /// steps kept inside the shrinking bracket, halving it when they leave it or take too long.
  template <class T>
  Status return_mobilised(const MeanShear<T>& trial, const T& gamma,
                          MeanShear<T>& end) const noexcept {
    constexpr int most_steps = 100;
    const T zero(0.0), per_stress(measure_ / shear_modulus_);
    detail::ConeNumbers<T> surface;
    const auto residual = [&](const T& x) {
      surface = at(gamma + x);
      end = detail::return_to_cone(trial, surface, bulk_modulus_, shear_modulus_);
      return x - per_stress * (trial.shear - end.shear);
    };
    T old_x = zero, old_r = residual(zero);
    const T scale =
        per_stress * (trial.shear + surface.slope * abs(trial.mean) + surface.intercept);
    if (all(old_r >= -T(1e-15) * scale)) return Status::ok;
    T low = zero, high = per_stress * trial.shear;
    T x = min(-old_r, high), r = residual(x);
    auto open = abs(r) > T(1e-13) * scale;
    for (int i = 0; i < most_steps && any(open); ++i) {
      low = select(r < zero, x, low);
      high = select(r < zero, high, x);
      const T rise = r - old_r;
      T next = x - r * (x - old_x) / select(abs(rise) > zero, rise, T(1.0));
      if (i > 10 && i % 2 == 0) next = T(-1.0);
      next = select((next > low) & (next < high), next, T(0.5) * (low + high));
      old_x = x;
      old_r = r;
      x = select(open, next, x);
      r = residual(x);
      open = open & (abs(r) > T(1e-13) * scale) & (high - low > T(4e-16) * high);
    }
    return any(abs(r) > T(1e-9) * scale) ? Status::failed : Status::ok;
  }

  Real bulk_modulus_, shear_modulus_, tensile_strength_;
  Real measure_;  ///< chosen measure per engineering plastic shear strain
  detail::ConeNumbers<Real> constant_;
  detail::StrengthPath path_;
  Cone cone_;
  bool mobilised_;
};

inline DruckerPrager::Prepared DruckerPrager::prepared() const noexcept {
  return Prepared(*this);
}

template <class T, int N>
Status DruckerPrager::update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                             State<T>& state) const noexcept {
  return prepared().update(step, stress, state);
}

inline void DruckerPrager::validate() const {
  elastic.validate();
  detail::validate_strength("", peak_strength());
  detail::validate_mobilisation(mobilisation, peak_strength());
  detail::validate_tensile_strength(tensile_strength);
  const auto refuse_steep_contraction = [&](const Strength<Real>& strength) {
    const Real sin_phi = std::sin(strength.friction_angle);
    const Real sin_psi = std::sin(strength.dilation_angle);
    const Real product = detail::cone_factor(cone, sin_phi, sin_psi) * sin_phi *
                         detail::cone_factor(cone, sin_psi, sin_psi) * sin_psi;
    if (elastic.shear_modulus() + elastic.bulk_modulus() * product <= 0)
      check::fail("dilation_angle", strength.dilation_angle, "values with G + K q_phi q_psi > 0",
                  "rad");
  };
  Strength<Real> worst = peak_strength();
  if (mobilisation.active())
    for (const auto& given : {mobilisation.onset, mobilisation.critical}) {
      const auto other = detail::StrengthPath::resolved(given, peak_strength());
      worst.friction_angle = std::max(worst.friction_angle, other.friction_angle);
      worst.dilation_angle = std::min(worst.dilation_angle, other.dilation_angle);
    }
  refuse_steep_contraction(worst);
}

}  // namespace vadose::law
