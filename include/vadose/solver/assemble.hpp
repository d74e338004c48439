// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// From a scene to the state of a run: points, soils, walls, loads.

#include <algorithm>
#include <utility>

#include <vadose/kernel/state.hpp>
#include <vadose/scene/scene.hpp>

namespace vadose::detail {

/// Values of one point in field order, written by tag.
template <class Fields>
class PointValues {
 public:
  template <class Tag>
  void set(Tag, Real value, int component = 0) {
    if constexpr (Fields::template has<Tag>)
      values_[static_cast<std::size_t>(Fields::template offset<Tag>() + component)] = value;
  }
  std::span<const double> all() const { return values_; }

 private:
  std::array<double, static_cast<std::size_t>(Fields::total)> values_{};
};

/// Radius factor of a volume: r in axisymmetry (quantities per radian), else 1.
template <class M>
Real radius_factor(const Vec<M::Kinematics::dim>& x) {
  return M::Kinematics::axisymmetric ? x[0] : 1;
}

/// Position, velocity, half size, id and volume of a new point.
template <class M, class Fields>
void set_common(PointValues<Fields>& p, const SeedPoint<M::Kinematics::dim>& seed,
                const Vec<M::Kinematics::dim>& velocity, Real spacing, std::int64_t id) {
  p.set(field::id, static_cast<Real>(id));
  p.set(field::volume, seed.volume * radius_factor<M>(seed.position));
  for (int d = 0; d < M::Kinematics::dim; ++d) {
    p.set(field::position, seed.position[d], d);
    p.set(field::velocity, velocity[d], d);
    // A hair smaller than the lattice: a domain that ends at a cell boundary must not reach the
    // next node by round-off, where a mass of 1e-30 kg would answer to a finite stress.
    p.set(field::half_size, 0.5 * spacing * (1 - 1e-9), d);
  }
}

/// Solid and pore-water points of one body of soil, as points of soil `group`. Each water point
/// starts where a solid point is and stays there.
/// DEVIATION: [Zhan] has no liquid points in dry soil; here they are there without mass, so that none
/// need be created at a wetting front.
template <class M>
void seed_soil(State<M>& state, const Scene<M>& scene, const InitialState<M>& initial, int index,
               int group, std::int64_t& next_solid, std::int64_t& next_liquid) {
  const auto& body = scene.soils()[static_cast<std::size_t>(index)];
  const Material<M> material = scene.material(body.material);
  const Real spacing = scene.cell_size() / body.lattice.per_axis;
  for (const auto& seed : scene.seed_soil(index)) {
    PointValues<SolidFields<M>> solid;
    set_common<M>(solid, seed, body.options.velocity, spacing, next_solid++);
    const Real volume = seed.volume * radius_factor<M>(seed.position);
    const Real density = is_finite(material.solid_density) ? material.solid_density : 2650;
    solid.set(field::mass, density * (1 - material.porosity) * volume);
    if constexpr (is_deformable<M>) {
      const auto stress = initial.bishop_stress(index, seed.position);
      for (int i = 0; i < stress.size; ++i) solid.set(field::bishop_stress, stress[i], i);
    }
    const auto numbers = law::initial_state(material.skeleton);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      solid.set(field::law_state, numbers[i], static_cast<int>(i));
    state.solid.append(solid.all(), group);
    if constexpr (has_liquid<M>) {
      PointValues<LiquidFields<M>> liquid;
      set_common<M>(liquid, seed, body.options.velocity, spacing, next_liquid++);
      const Real p = initial.liquid_pressure(index, seed.position);
      const auto theta = swrc::water_content<Real>(material.retention, p, material.porosity,
                                                   1 / state.water.bulk_modulus);
      liquid.set(field::mass, body.options.dry ? 0 : state.water.density * volume * theta.value);
      liquid.set(field::porosity, material.porosity);
      liquid.set(field::liquid_pressure, p);
      state.liquid.append(liquid.all(), group);
    }
  }
}

/// Points of one body of free water.
template <class M>
void seed_water(State<M>& state, const Scene<M>& scene, const InitialState<M>& initial, int index,
                std::int64_t& next) {
  const auto& body = scene.waters()[static_cast<std::size_t>(index)];
  const Real spacing = scene.cell_size() / body.lattice.per_axis;
  for (const auto& seed : scene.seed_water(index)) {
    PointValues<LiquidFields<M>> liquid;
    set_common<M>(liquid, seed, body.options.velocity, spacing, next++);
    const Real p = initial.water_pressure(index, seed.position);
    const Real volume = seed.volume * radius_factor<M>(seed.position);
    liquid.set(field::mass, state.water.density * volume * std::exp(p / state.water.bulk_modulus));
    liquid.set(field::porosity, 1);
    liquid.set(field::liquid_pressure, p);
    state.liquid.append(liquid.all(), state.free_group());
  }
}

/// Soils with everything derived from their parameters.
template <class M>
void prepare_soils(State<M>& state, const Scene<M>& scene) {
  if constexpr (has_skeleton<M>) {
    if (scene.materials().size() > max_materials)
      check::fail("number of soils", static_cast<Real>(scene.materials().size()), "[0, 8]", "-");
    for (std::size_t i = 0; i < scene.materials().size(); ++i) {
      const Material<M> m = scene.material(static_cast<int>(i));
      Soil<M> soil{.material = m, .law = law::prepared(m.skeleton), .kirchhoff = std::nullopt};
      const auto numbers = law::initial_state(m.skeleton);
      soil.p_wave_modulus = law::p_wave_modulus(m.skeleton, numbers.data());
      soil.shear_modulus = law::shear_modulus(m.skeleton, numbers.data());
      if constexpr (is_unsaturated<M>) {
        const Real residual = swrc::residual_saturation(m.retention);
        soil.pressure_floor = -std::min(
            swrc::suction(m.retention, residual + driest_effective_saturation * (1 - residual),
                          m.porosity),
            1e9);
        soil.kirchhoff.emplace(m.retention, m.conductivity, m.porosity);
      }
      state.soils.push_back(std::move(soil));
    }
  }
}

/// Place and time of a liquid condition.
template <class M, class Condition>
HeldPressure<M::Kinematics::dim> held_place(const Condition& c, HeldKind kind) {
  constexpr int dim = M::Kinematics::dim;
  HeldPressure<dim> h;
  h.kind = kind;
  if constexpr (requires { c.face; })
    if (c.face != unset_face) {
      h.face_axis = axis(c.face, dim);
      h.face_side = side(c.face);
    }
  h.limited = c.region.given();
  h.active = c.active;
  h.contains = [region = c.region](const Vec<dim>& x) { return region.contains(x); };
  h.pressure = [](const Vec<dim>&, Real) { return Real(0); };
  return h;
}

/// Pressure under still water whose surface is at level(t), negative above it.
template <class M, class Condition>
HeldPressure<M::Kinematics::dim> held_level(const State<M>& state, const Condition& c,
                                            HeldKind kind) {
  constexpr int dim = M::Kinematics::dim;
  auto h = held_place<M>(c, kind);
  h.pressure = [c, gravity = state.gravity, weight = state.water.density * state.gravity.norm()](
                   const Vec<dim>& x, Real t) { return weight * (c.at(t) - height(x, gravity)); };
  return h;
}

/// What the kernels need of a liquid condition.
template <class M>
auto held_pressure(const State<M>&, const bc::PrescribedPressure<M::Kinematics::dim>& c) {
  auto h = held_place<M>(c, HeldKind::open);
  h.pressure = [c](const Vec<M::Kinematics::dim>& x, Real t) { return c.at(x, t); };
  return h;
}
template <class M>
auto held_pressure(const State<M>& state, const bc::Drained& c) {
  return held_pressure(state, c.template prescribed<M::Kinematics::dim>());
}
template <class M>
auto held_pressure(const State<M>& state, const bc::PrescribedHead& c) {
  return held_level(state, c, HeldKind::open);
}
template <class M>
auto held_pressure(const State<M>& state, const bc::Reservoir& c) {
  return held_level(state, c, HeldKind::reservoir);
}
template <class M>
auto held_pressure(const State<M>&, const bc::Drain& c) {
  auto h = held_place<M>(c, HeldKind::outlet);
  h.pressure = [p = c.pressure](const Vec<M::Kinematics::dim>&, Real) { return p; };
  return h;
}
template <class M>
auto held_pressure(const State<M>& state, const bc::SeepageFace& c) {
  return held_pressure(state, c.drain());
}
template <class M>
auto held_pressure(const State<M>&, const bc::Impermeable& c) {
  return held_place<M>(c, HeldKind::closed);
}
template <class M>
auto held_pressure(const State<M>&, const bc::ZeroSuction& c) {
  return held_place<M>(c, HeldKind::open);
}
template <class M>
auto held_pressure(const State<M>&, const bc::Rain& c) {
  auto h = held_place<M>(c, HeldKind::rain);
  h.supply = [c](Real t) { return c.at(t); };
  constexpr int dim = M::Kinematics::dim;
  for (int d = 0; d + 1 < dim; ++d) h.drift[d] = c.drift(d, dim);
  if (M::Kinematics::axisymmetric && h.drift[0] != 0)
    check::fail("direction r", c.direction[0], "{0} in axisymmetry", "-");
  return h;
}

/// Adds a liquid condition: those limited to a region go before those that are not.
template <class M, class Condition>
void add_held(State<M>& state, const Condition& condition) {
  auto h = held_pressure(state, condition);
  if (h.active) h.acts = h.active(state.time);
  if constexpr (std::is_same_v<Condition, bc::Rain>) state.roughness = condition.roughness;
  auto at = state.held.end();
  if (h.limited)
    at = std::find_if(state.held.begin(), state.held.end(),
                      [](const auto& other) { return !other.limited; });
  state.held.insert(at, std::move(h));
}

/// Adds all liquid conditions of some types in a scene.
template <class... Conditions, class M>
void add_all_held(State<M>& state, const Scene<M>& scene) {
  const auto add = [&](const auto& list) {
    for (const auto& c : list) add_held(state, c);
  };
  (add(scene.template conditions<Conditions>()), ...);
}

/// Axis along which a box is thinnest.
template <int Dim>
int thinnest_axis(const Box<Dim>& box) {
  int best = 0;
  for (int d = 1; d < Dim; ++d)
    if (box.high[d] - box.low[d] < box.high[best] - box.low[best]) best = d;
  return best;
}

/// Loads of one traction condition: one piece of surface per exposed side of a solid point of the
/// region. A pressure acts on every exposed side, a traction vector on the sides across the
/// region's thinnest extent (the layer the user chose).
template <class M>
void add_traction(State<M>& state, const Scene<M>& scene,
                  const bc::Traction<M::Kinematics::dim>& t) {
  constexpr int dim = M::Kinematics::dim;
  state.factors.push_back(t.time_factor);
  const std::size_t factor = state.factors.size() - 1;
  const Region<dim>& region = *t.region.template get<dim>();
  const int across = thinnest_axis(region.bounding_box());
  const auto exposed = [&](const Vec<dim>& next, const Vec<dim>& surface, int d, Real spacing) {
    for (const auto& other : scene.soils())
      if (other.region.contains(next)) return false;
    return surface[d] > scene.box().low[d] + 1e-9 * spacing &&
           surface[d] < scene.box().high[d] - 1e-9 * spacing;
  };
  const std::size_t before = state.loads.size();
  for (std::size_t i = 0; i < scene.soils().size(); ++i) {
    const Real spacing = scene.cell_size() / scene.soils()[i].lattice.per_axis;
    for (const auto& seed : scene.seed_soil(static_cast<int>(i))) {
      if (!region.contains(seed.position)) continue;
      for (int d = 0; d < dim; ++d)
        for (int sign = -1; sign <= 1; sign += 2) {
          Vec<dim> next = seed.position, surface = seed.position;
          next[d] += sign * spacing;
          surface[d] += 0.5 * sign * spacing;
          if ((t.has_vector() && d != across) || !exposed(next, surface, d, spacing)) continue;
          const Real area = power<dim - 1>(spacing) * radius_factor<M>(surface);
          Vec<dim> force = Vec<dim>::Zero();
          if (t.has_pressure())
            force[d] = -sign * t.normal_pressure * area;
          else
            force = t.traction * area;
          state.loads.push_back({surface, force, factor});
        }
    }
  }
  if (state.loads.size() == before)
    throw SetupError(
        "number of loaded surface points = 0 outside [1, inf) [-] in region of bc::Traction");
}

/// Everything but the points' order and the walls.
template <class M>
void assemble(State<M>& state, const Scene<M>& scene) {
  constexpr int dim = State<M>::dim;
  Index<dim> cells;
  for (int d = 0; d < dim; ++d) cells[d] = scene.cells()[static_cast<std::size_t>(d)];
  state.grid = BlockGrid<dim>(scene.box().low, scene.cell_size(), cells);
  state.gravity = scene.gravity;
  state.water = {scene.liquid.density, scene.liquid.bulk_modulus};
  state.fluid = scene.liquid.law;
  prepare_soils(state, scene);
  const InitialState<M> initial = scene.initial_state();
  std::int64_t next_solid = 0, next_liquid = 0;
  if constexpr (has_skeleton<M>) {
    for (std::size_t i = 0; i < scene.soils().size(); ++i)
      seed_soil(state, scene, initial, static_cast<int>(i), scene.soils()[i].material, next_solid,
                next_liquid);
  }
  if constexpr (has_liquid<M>) {
    for (std::size_t i = 0; i < scene.waters().size(); ++i)
      seed_water(state, scene, initial, static_cast<int>(i), next_liquid);
    add_all_held<bc::Impermeable, bc::PrescribedPressure<dim>, bc::PrescribedHead>(state, scene);
    if constexpr (has_skeleton<M>)
      add_all_held<bc::Reservoir, bc::Drain, bc::ZeroSuction, bc::Rain>(state, scene);
    state.next_liquid_id = next_liquid;
  }
  if constexpr (is_deformable<M>)
    for (const auto& t : scene.template conditions<bc::Traction<dim>>())
      add_traction(state, scene, t);
}

}  // namespace vadose::detail
