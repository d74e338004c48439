// SPDX-License-Identifier: MIT
// What a point costs, by model: bytes, and wall time of an explicit step on one thread. Prints the rows
// of the README's table "Physics by model".

#include <algorithm>
#include <chrono>
#include <cstdio>

#include <vadose/vadose.hpp>

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

template <class Preset>
struct Rigid : Preset {
  using Skeleton = vd::law::Rigid;
};
template <class Preset>
struct Plastic : Preset {
  using Skeleton = vd::law::DruckerPrager;
};

template <class M>
vd::Material<M> soil() {
  vd::Material<M> m{.name = "soil", .porosity = 0.4};
  if constexpr (!vd::is_rigid<M>) m.solid_density = 2650;
  if constexpr (std::is_same_v<typename M::Skeleton, vd::law::DruckerPrager>)
    m.skeleton = {.elastic = {.young_modulus = 1e7, .poisson_ratio = 0.3},
                  .cohesion = 1e3,
                  .friction_angle = vd::degrees(30)};
  else if constexpr (!vd::is_rigid<M>)
    m.skeleton = {.young_modulus = 1e7, .poisson_ratio = 0.3};
  if constexpr (vd::is_unsaturated<M>) {
    m.lambda = 0.63;
    m.retention = {.a = 3};
  }
  if constexpr (vd::has_liquid<M>) m.conductivity = {.saturated_conductivity = 1e-4};
  return m;
}

/// A block of 100 x 100 or 20 x 20 x 20 cells, full of soil, or of water where M has no soil.
template <class M>
vd::Solver<M> block() {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  const int cells = dim == 2 ? 100 : 20;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(cells), top = high;
  high[up] += 4;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = 1});
  scene.gravity[up] = -1;
  if constexpr (vd::has_skeleton<M>) {
    vd::SoilOptions<dim> start;
    if constexpr (!vd::is_rigid<M>) start.initial_stress = vd::InitialStress::geostatic;
    if constexpr (vd::is_unsaturated<M>)
      start.saturation = 0.6;
    else if constexpr (vd::has_liquid<M>)
      start.water_table = top[up];
    scene.add_soil(vd::box<dim>(low, top), soil<M>(), start);
    if constexpr (!vd::is_rigid<M>) scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  } else {
    scene.add_water(vd::box<dim>(low, top), {.surface_level = top[up]});
  }
  return vd::Solver<M>(scene);
}

/// Shortest mean time of a step over several spells of 0.3 s [ns].
template <class S>
Real step_time(S& solver) {
  using Clock = std::chrono::steady_clock;
  Real best = 1e30;
  for (int spell = 0; spell < 4; ++spell) {
    const auto start = Clock::now();
    Real spent = 0;
    int steps = 0;
    while (spent < 0.3) {
      if (solver.step().status != vd::Status::ok) return vd::unset;
      ++steps;
      spent = std::chrono::duration<Real>(Clock::now() - start).count();
    }
    best = std::min(best, spent / steps);
  }
  return 1e9 * best;
}

/// Bytes of a solid and a liquid point, and the time of a step per solid point (with its liquid
/// point), or per liquid point where there is no soil.
template <class M>
void row(const char* name, const char* space) {
  using State = vd::State<M>;
  auto solver = block<M>();
  const Real points =
      static_cast<Real>(vd::has_skeleton<M> ? solver.solid().size() : solver.liquid().size());
  std::printf("| %s | %s | %d | %d | %.0f |\n", name, space,
              vd::has_skeleton<M> ? State::Solid::bytes_per_point : 0,
              vd::has_liquid<M> ? State::Liquid::bytes_per_point : 0, step_time(solver) / points);
  std::fflush(stdout);
}

template <class K>
void rows(const char* space) {
  row<vd::DryModel<K>>("DryModel", space);
  row<Plastic<vd::DryModel<K>>>("DryModel, DruckerPrager", space);
  row<vd::SaturatedModel<K>>("SaturatedModel", space);
  row<vd::UnsaturatedModel<K>>("UnsaturatedModel", space);
  row<Plastic<vd::UnsaturatedModel<K>>>("UnsaturatedModel, DruckerPrager", space);
  row<Rigid<vd::UnsaturatedModel<K>>>("UnsaturatedModel, Rigid", space);
  row<vd::FreeWaterModel<K>>("FreeWaterModel", space);
}

}  // namespace

int main() {
  std::printf(
      "| model | space | bytes, solid point | bytes, liquid point | ns per step and pair of points "
      "|\n"
      "| --- | --- | --- | --- | --- |\n");
  rows<vd::PlaneStrain>("plane");
  rows<vd::ThreeDimensional>("3D");
}
