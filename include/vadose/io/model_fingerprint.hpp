// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What a file of state must share with the run that takes it: a list of named entries.

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <vadose/kernel/state.hpp>
#include <vadose/policy/law/law_concept.hpp>

namespace vadose::io::detail {

/// Name of a type; unnamed namespaces are left out, since compilers spell them differently.
template <class T>
const char* spelled_type() noexcept {
  return __PRETTY_FUNCTION__;
}
template <class T>
std::string type_name() {
  std::string name = spelled_type<T>();
  name = name.substr(name.find("T = ") + 4);
  name = name.substr(0, name.rfind(']'));
  for (const std::string_view unnamed : {"{anonymous}::", "(anonymous namespace)::", "<unnamed>::"})
    for (std::size_t at; (at = name.find(unnamed)) != std::string::npos;)
      name.erase(at, unnamed.size());
  return name;
}

/// One entry: a text, or a number that may differ by round-off.
struct FingerprintEntry {
  std::string name;
  std::string text;
  Real number = 0;
  bool is_number = false;

  bool agrees_with(const FingerprintEntry& other) const noexcept {
    if (name != other.name || text != other.text || is_number != other.is_number) return false;
    const Real a = number, b = other.number;
    return a == b || (a != a && b != b) ||
           std::fabs(a - b) <= 1e-9 * std::fmax(std::fabs(a), std::fabs(b));
  }
  std::string value() const {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.12g", number);
    return is_number ? buffer : "'" + text + "'";
  }
};

/// The fingerprint of a run. Materials are told by what they do, not by their members: the stress,
/// saturation, conductivity and drag at fixed arguments. So it holds for any policy.
class ModelFingerprint {
 public:
  ModelFingerprint() = default;

  /// Of a state of model M that Scheme advances.
  template <class Scheme, class M>
  static ModelFingerprint of(const State<M>& state) {
    ModelFingerprint f;
    f.add_types<M>();
    f.text("scheme", type_name<Scheme>());
    f.add_fields<typename State<M>::Solid::fields>("solid");
    f.add_fields<typename State<M>::Liquid::fields>("liquid");
    f.add_grid(state);
    f.add_liquid(state);
    f.number("number of soils", static_cast<Real>(state.soils.size()));
    if constexpr (has_skeleton<M>)
      for (const auto& soil : state.soils) f.add_soil(soil, state.water.density);
    f.add_conditions(state);
    return f;
  }

  /// Says what differs first, "" if nothing does.
  std::string difference(const ModelFingerprint& run) const {
    for (std::size_t i = 0; i < std::max(entries.size(), run.entries.size()); ++i) {
      if (i >= entries.size()) return run.entries[i].name + " is not in the file";
      if (i >= run.entries.size()) return entries[i].name + " is not in the run";
      const auto &a = entries[i], &b = run.entries[i];
      if (a.name != b.name) return a.name + " in the file is " + b.name + " in the run";
      if (!a.agrees_with(b))
        return a.name + " is " + a.value() + " in the file, " + b.value() + " in the run";
    }
    return "";
  }

  std::vector<FingerprintEntry> entries;

 private:
  void text(std::string name, std::string value) {
    entries.push_back({std::move(name), std::move(value), 0, false});
  }
  void number(std::string name, Real value) {
    entries.push_back({std::move(name), "", value, true});
  }

  template <class M>
  void add_types() {
    number("dimension", M::Kinematics::dim);
    text("Kinematics", type_name<typename M::Kinematics>());
    text("Shape", type_name<typename M::Shape>());
    text("Transfer", type_name<typename M::Transfer>());
    text("Skeleton", type_name<typename M::Skeleton>());
    text("Liquid", type_name<typename M::Liquid>());
    text("Retention", type_name<typename M::Retention>());
    text("Conductivity", type_name<typename M::Conductivity>());
    text("Drag", type_name<typename M::Drag>());
    text("Interblock", type_name<typename M::Interblock>());
    number("size of a number", sizeof(Real));
    number("points per batch", lane_count);
  }
  template <class Fields>
  void add_fields(const std::string& phase) {
    Fields::for_each([&](auto tag, int components) {
      number(phase + " field " + decltype(tag)::name, components);
    });
    number(phase + " numbers per point", Fields::total);
  }
  template <class M>
  void add_grid(const State<M>& state) {
    number("cell size", state.grid.cell_size());
    for (int d = 0; d < State<M>::dim; ++d) {
      const std::string axis = " along axis " + std::to_string(d);
      number("origin" + axis, state.grid.origin()[d]);
      number("cells" + axis, state.grid.cells()[d]);
      number("gravity" + axis, state.gravity[d]);
    }
  }
  template <class M>
  void add_liquid(const State<M>& state) {
    number("liquid density", state.water.density);
    number("liquid bulk modulus", state.water.bulk_modulus);
    if constexpr (is_viscous<M>) {
      SymTensor<Lanes, State<M>::stress_size> rate;
      for (int i = 0; i < rate.size; ++i) rate[i] = Lanes(i + 1.0);
      number("liquid viscous stress", state.fluid.viscous_stress(rate)[0][0]);
    }
  }

  template <class M>
  void add_soil(const Soil<M>& soil, Real liquid_density) {
    const auto& m = soil.material;
    const std::string of = " of " + m.label();
    if (!is_rigid<M>) number("solid_density" + of, m.solid_density);
    number("porosity" + of, m.porosity);
    number("unit_weight" + of, m.unit_weight);
    if constexpr (!is_rigid<M>) add_law<M::Kinematics::stress_size>(m.skeleton, of);
    if constexpr (has_liquid<M>) add_hydraulics(m, of, liquid_density);
  }
  /// Stress along a path of compression, shear and extension, up to strains of 4 %.
  template <int N, class L>
  void add_law(const L& law, const std::string& of) {
    auto state = law::initial_state(law);
    number("p_wave_modulus" + of, law::p_wave_modulus(law, state.data()));
    SymTensor<Real, N> stress;
    for (int k = 0; k < 12; ++k) {
      StrainStep<Real, N> step;
      step.dt = 1e-3;
      for (int i = 0; i < N; ++i)
        step.increment[i] = 2e-5 * power<3>(k + 1.0) * ((i * 5 + k * 3) % 7 - (k < 8 ? 4 : 1));
      law::apply(law, step, stress, state.data());
      Real sum = 0;
      for (int i = 0; i < N; ++i) sum += (1 + 0.1 * i) * stress[i];
      number("stress " + std::to_string(k) + of, sum);
    }
  }
  template <class Mat>
  void add_hydraulics(const Mat& m, const std::string& of, Real liquid_density) {
    for (const Real n : {m.porosity, 0.8 * m.porosity}) {
      const std::string at = " at n = " + check::text(n) + of;
      if constexpr (!is_always_saturated<std::remove_cvref_t<decltype(m.retention)>>)
        for (const Real s : {1.0, 1e2, 1e3, 1e4, 1e5, 1e6})
          number("saturation at s = " + check::text(s) + at, swrc::saturation(m.retention, s, n));
      for (const Real e : {0.05, 0.3, 0.7, 1.0})
        number("conductivity at S_e = " + check::text(e) + at,
               conductivity::value(m.conductivity, e, n));
      number("drag" + at, drag::coefficient(m.drag, n, 0.7, 1e-4, m.unit_weight));
      number("quadratic drag" + at,
             drag::quadratic(m.drag, n, 0.7, 1e-4, m.unit_weight, liquid_density));
    }
  }

  template <class M>
  void add_conditions(const State<M>& state) {
    number("number of liquid conditions", static_cast<Real>(state.held.size()));
    for (std::size_t i = 0; i < state.held.size(); ++i) {
      const std::string of = " of liquid condition " + std::to_string(i);
      number("kind" + of, static_cast<Real>(state.held[i].kind));
      number("face axis" + of, state.held[i].face_axis);
      number("face side" + of, state.held[i].face_side);
      number("region" + of, state.held[i].limited);
    }
    number("roughness", state.roughness);
    number("number of time factors", static_cast<Real>(state.factors.size()));
  }
};

}  // namespace vadose::io::detail
