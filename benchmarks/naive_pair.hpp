// SPDX-License-Identifier: MIT
#pragma once

// Unsaturated soil as one writes it down first: see naive.hpp. The same physics as the library's
// explicit scheme in a closed box that soil fills: no air beside it, no free water, no condition on
// the water; walls smooth, the floor fixed. Retention, conductivity, their mean over a face and the
// drag are the library's, in plain doubles.

#include "benchmarks/naive.hpp"

namespace naive {

// A pore-water point.
template <int Dim>
struct Water {
  std::int64_t id = 0;
  Vector<Dim> position, velocity, half_size;
  double mass = 0, volume = 0, porosity = 0, pressure = 0;
};

// A node of both phases.
template <int Dim>
struct PairNode {
  double solid_mass = 0, skeleton_volume = 0, liquid_mass = 0;
  Vector<Dim> solid_momentum, solid_force, liquid_momentum;
  Vector<Dim> solid, solid_change, liquid, liquid_change;
  Vector<Dim> relative, head_gradient;  // n (v^l - v^s); mean over the faces through the node
  Vector<Dim> drive;                    // head gradient that the relative velocity answers to
  bool wall[Dim] = {}, fixed[Dim] = {};
};

// A cell and its lower face along each axis.
template <int Dim>
struct PairCell {
  double volume = 0, water = 0, pores = 0, pressure = 0;
  Vector<Dim> centroid, momentum, velocity, momentum_gain;
  double content = 0, storage = 0, saturation = 0, porosity = 0;
  double conductivity = 0, saturated_conductivity = 0, modulus = 0;
  double skeleton_volume = 0, mean_stress = 0, rate = 0, gain = 0, change = 0;
  bool found = false;
  double face_gradient[Dim], face_saturation[Dim], face_conductivity[Dim], face_flux[Dim];
};

template <class M>
class PairRun {
  static constexpr int Dim = M::Kinematics::dim;
  static constexpr int corners = 1 << Dim;

 public:
  // Takes points and numbers over from a solver that has not stepped yet.
  template <class Solver>
  explicit PairRun(const Solver& solver)
      : soil_(solver.state().soils[0]),
        sand_(soil_.material.skeleton),
        gravity_(solver.state().gravity),
        density_(solver.state().water.density),
        bulk_modulus_(solver.state().water.bulk_modulus),
        pic_rate_(solver.state().transfer.pic_rate),
        courant_(solver.state().options.courant),
        displacement_cap_(solver.state().options.displacement_cap) {
    grid_.origin = solver.state().grid.origin();
    grid_.h = solver.state().grid.cell_size();
    for (int d = 0; d < Dim; ++d) grid_.cells[d] = solver.state().grid.cells()[d];
    nodes_.resize(grid_.size());
    cells_.resize(grid_.size());  // by their lower node; the last of each row stays empty
    mark_walls();
    points_ = take_solid<Dim>(solver.solid());
    take_water(solver.liquid());
    wave2_ = soil_.p_wave_modulus / (soil_.material.solid_density * (1 - soil_.material.porosity));
  }

  const std::vector<Point<Dim>>& points() const { return points_; }
  const std::vector<Water<Dim>>& water() const { return water_; }

  void step() {
    sum_cells();
    find_pressures();
    find_step();
    find_faces();
    map_water();
    map_solid();
    for_nodes([&](PairNode<Dim>& node, const int(&i)[Dim]) { advance(node, i); });
    for_cells([&](PairCell<Dim>& c, const int(&i)[Dim]) { find_fluxes(c, i); });
    for_cells([&](PairCell<Dim>& c, const int(&i)[Dim]) { find_gain(c, i); });
    wave2_ = speed2_ = 0;
    for (auto& p : points_) strain(p);
    for (auto& p : points_) move(p);
    for (auto& c : cells_)
      if (c.pores > 0) predict(c);
    for (auto& w : water_) drive(w);
    mean_velocities();
    for_cells([&](PairCell<Dim>& c, const int(&i)[Dim]) { find_momentum_gain(c, i); });
    for (auto& w : water_) exchange(w);
    for (auto& w : water_) carry(w);
  }

 private:
  template <class F>
  void for_nodes(F&& f) {
    int i[Dim] = {};
    for (auto& node : nodes_) {
      f(node, i);
      int d = 0;
      while (d < Dim && ++i[d] > grid_.cells[d]) i[d++] = 0;
    }
  }
  template <class F>
  void for_cells(F&& f) {
    for_nodes([&](PairNode<Dim>& node, const int(&i)[Dim]) {
      for (int d = 0; d < Dim; ++d)
        if (i[d] == grid_.cells[d]) return;
      f(cells_[static_cast<std::size_t>(&node - nodes_.data())], i);
    });
  }
  void mark_walls() {
    for_nodes([&](PairNode<Dim>& node, const int(&i)[Dim]) {
      for (int d = 0; d < Dim; ++d) {
        node.wall[d] = i[d] == 0 || i[d] == grid_.cells[d];
        node.fixed[d] = node.wall[d] || i[Dim - 1] == 0;
      }
    });
  }
  template <class Points>
  void take_water(const Points& points) {
    using namespace vadose;
    points.for_each([&](std::size_t b, int l) {
      Water<Dim> w;
      w.id = static_cast<std::int64_t>(points.at(field::id, b)[l]);
      for (int d = 0; d < Dim; ++d) {
        w.position[d] = points.at(field::position, b, d)[l];
        w.velocity[d] = points.at(field::velocity, b, d)[l];
        w.half_size[d] = points.at(field::half_size, b, d)[l];
      }
      w.mass = points.at(field::mass, b)[l];
      w.volume = points.at(field::volume, b)[l];
      w.porosity = points.at(field::porosity, b)[l];
      w.pressure = points.at(field::liquid_pressure, b)[l];
      water_.push_back(w);
    });
    std::shuffle(water_.begin(), water_.end(), std::mt19937_64(2));
  }

  PairCell<Dim>& cell_at(const Vector<Dim>& x) {
    int i[Dim];
    for (int d = 0; d < Dim; ++d)
      i[d] = std::clamp(static_cast<int>(std::floor((x[d] - grid_.origin[d]) / grid_.h)), 0,
                        grid_.cells[d] - 1);
    return cells_[grid_.number(i)];
  }
  double hydrostatic(const Vector<Dim>& from, const Vector<Dim>& to) const {
    return density_ * gravity_.dot(to - from);
  }
  Vector<Dim> centre(const int (&i)[Dim]) const {
    Vector<Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = grid_.origin[d] + (i[d] + 0.5) * grid_.h;
    return x;
  }

  void sum_cells() {
    for (auto& c : cells_) {
      c.volume = c.water = c.pores = c.pressure = 0;
      c.skeleton_volume = c.mean_stress = 0;
      c.centroid.setZero();
      c.found = false;
    }
    for (const auto& w : water_) {
      auto& c = cell_at(w.position);
      const double pores = w.porosity * w.volume;
      c.volume += w.volume;
      c.water += w.mass;
      c.pores += pores;
      c.pressure += pores * w.pressure;
      c.centroid += pores * w.position;
    }
    for (auto& c : cells_) {
      if (!(c.pores > 0)) continue;
      c.pressure /= c.pores;
      c.centroid /= c.pores;
      c.porosity = c.pores / c.volume;
    }
  }

  // Newton on the water that the cell would hold at a pressure.
  void find_pressures() {
    for (bool all = false; !all;) {
      for (auto& c : cells_)
        if (!c.found) c.content = c.storage = 0;
      for (const auto& w : water_) {
        auto& c = cell_at(w.position);
        if (c.found) continue;
        const auto theta = vadose::swrc::water_content<double>(
            soil_.material.retention, c.pressure + hydrostatic(c.centroid, w.position), w.porosity,
            1 / bulk_modulus_);
        c.content += w.volume * theta.value;
        c.storage += w.volume * theta.slope;
      }
      all = true;
      for (auto& c : cells_) {
        if (c.found || !(c.pores > 0)) continue;
        const double excess = c.content - c.water / density_;
        if (std::abs(excess) <= 1e-14 * c.pores) {
          c.found = true;
          continue;
        }
        const double change = -excess / c.storage;
        c.pressure += change;
        c.found = std::abs(excess) <= 1e-7 * c.pores &&
                  std::abs(change) <= 1e-3 * std::abs(c.pressure - change) + 1;
        all = all && c.found;
      }
    }
    for (auto& c : cells_) {
      if (!(c.pores > 0)) continue;
      const double compression = std::exp(c.pressure / bulk_modulus_);
      c.saturation = std::min(1.0, c.water / density_ / (c.pores * compression));
      c.modulus = c.saturation * compression * c.pores / c.storage;
    }
  }

  void find_step() {
    dt_ = 1e30;
    for (const auto& c : cells_) {
      if (!(c.pores > 0)) continue;
      const double n = c.porosity, solid = (1 - n) * soil_.material.solid_density;
      const double tr =
          c.modulus / density_ +
          (soil_.p_wave_modulus + c.saturation * (1 - n) * (1 - n) * c.modulus / n) / solid;
      const double det = c.modulus * soil_.p_wave_modulus / (solid * density_);
      const double frequency2 =
          2 / (grid_.h * grid_.h) * (tr + std::sqrt(std::max(0.0, tr * tr - 4 * det)));
      dt_ = std::min(dt_, 2 / std::sqrt(frequency2));
    }
    dt_ = courant_ * std::min(dt_, grid_.h / std::sqrt(wave2_));
    if (speed2_ > 0) dt_ = std::min(dt_, displacement_cap_ * grid_.h / std::sqrt(speed2_));
    keep_ = std::exp(-pic_rate_ * dt_);
  }

  void find_faces() {
    using namespace vadose;
    const auto& material = soil_.material;
    for_cells([&](PairCell<Dim>& c, const int(&)[Dim]) {
      double s = 1;
      if (c.pressure < 0)
        s = c.pressure > soil_.pressure_floor
                ? swrc::saturation_and_slope<Real>(material.retention, -c.pressure, c.porosity)
                      .saturation
                : c.saturation;
      c.saturated_conductivity = conductivity::value<Real>(material.conductivity, 1, c.porosity);
      c.conductivity = conductivity::value<Real>(
          material.conductivity,
          s < 1 ? swrc::effective_saturation<Real>(material.retention, s) : 1.0, c.porosity);
    });
    for_cells([&](PairCell<Dim>& b, const int(&i)[Dim]) {
      for (int axis = 0; axis < Dim; ++axis) {
        b.face_saturation[axis] = -1;  // a wall
        if (i[axis] == 0) continue;
        const PairCell<Dim>& a = below(i, axis);
        const double distance = std::max(0.5 * grid_.h, b.centroid[axis] - a.centroid[axis]);
        const double drop = b.pressure - a.pressure - hydrostatic(a.centroid, b.centroid);
        const PairCell<Dim>& up = drop > 0 ? b : a;
        b.face_gradient[axis] = drop / distance;
        b.face_saturation[axis] = up.saturation;
        // As much water as both cells hold in the mean; their saturated half ways in series.
        double factor = 0.5 * (a.saturation + b.saturation) / up.saturation;
        if (a.saturated_conductivity != b.saturated_conductivity)
          factor *= 2 * (drop > 0 ? a : b).saturated_conductivity /
                    (a.saturated_conductivity + b.saturated_conductivity);
        double k = up.conductivity;
        if (a.pressure < 0 || b.pressure < 0)
          k = blend_conductivity<Real>(
              k, soil_.kirchhoff->mean(a.pressure, b.pressure, up.porosity),
              density_ * std::abs(gravity_[axis]) * distance, b.pressure - a.pressure);
        b.face_conductivity[axis] = factor * k;
      }
    });
  }
  PairCell<Dim>& below(const int (&i)[Dim], int axis) {
    int j[Dim];
    for (int d = 0; d < Dim; ++d) j[d] = i[d] - (d == axis ? 1 : 0);
    return cells_[grid_.number(j)];
  }

  void map_water() {
    for (auto& node : nodes_) {
      node.liquid_mass = 0;
      node.liquid_momentum.setZero();
    }
    for (const auto& w : water_) {
      const auto list = grid_.hat_nodes(w.position);
      for (int a = 0; a < list.count; ++a) {
        nodes_[list.node[a]].liquid_mass += list.value[a] * w.mass;
        nodes_[list.node[a]].liquid_momentum += list.value[a] * w.mass * w.velocity;
      }
    }
  }

  void map_solid() {
    for (auto& node : nodes_) {
      node.solid_mass = node.skeleton_volume = 0;
      node.solid_momentum.setZero();
      node.solid_force.setZero();
    }
    for (const auto& p : points_) {
      const auto list = grid_.gimp_nodes(p.position, p.half_size);
      for (int a = 0; a < list.count; ++a) {
        auto& node = nodes_[list.node[a]];
        node.solid_mass += list.value[a] * p.mass;
        node.skeleton_volume += list.value[a] * p.volume;
        node.solid_momentum += list.value[a] * p.mass * p.velocity;
      }
    }
    for (const auto& p : points_) {
      const auto list = grid_.gimp_nodes(p.position, p.half_size);
      const double mean = p.stress.trace() / 3;
      const Eigen::Matrix<double, Dim, Dim> deviator =
          p.stress.template topLeftCorner<Dim, Dim>() -
          mean * Eigen::Matrix<double, Dim, Dim>::Identity();
      for (int a = 0; a < list.count; ++a)
        nodes_[list.node[a]].solid_force +=
            list.value[a] * p.mass * gravity_ - p.volume * (deviator * list.gradient[a]);
      auto& c = cell_at(p.position);
      c.skeleton_volume += p.volume;
      c.mean_stress += p.volume * mean;
    }
    for (auto& c : cells_)
      if (c.skeleton_volume > 0) c.mean_stress /= c.skeleton_volume;
  }

  // Gradient of the hat function of corner `corner` of a cell at its middle.
  Vector<Dim> corner_gradient(int corner) const {
    Vector<Dim> g;
    for (int d = 0; d < Dim; ++d) g[d] = ((corner >> d) & 1 ? 1 : -1) / grid_.h / (corners / 2);
    return g;
  }

  void advance(PairNode<Dim>& node, const int (&i)[Dim]) {
    const double full = std::pow(grid_.h, Dim);
    double volume = 0, pores = 0;
    Vector<Dim> force = Vector<Dim>::Zero(), soil_force = force, skeleton_force = force;
    double cell_saturation = 0, cell_conductivity = 0;
    double saturation[Dim] = {}, conductivity[Dim] = {}, gradient[Dim] = {};
    int cells = 0, faces[Dim] = {};
    for (int corner = 0; corner < corners; ++corner) {
      int j[Dim];
      bool inside = true;
      for (int d = 0; d < Dim; ++d) {
        j[d] = i[d] - ((corner >> d) & 1);
        inside = inside && j[d] >= 0 && j[d] < grid_.cells[d];
      }
      if (!inside) continue;
      const PairCell<Dim>& c = cells_[grid_.number(j)];
      const Vector<Dim> g = corner_gradient(corner);
      const double p = c.pressure + hydrostatic(c.centroid, centre(j));
      volume += full / corners;
      pores += full / corners * c.porosity;
      force += full * p * g;
      soil_force += full * c.saturation * p * g;
      skeleton_force -= full * c.mean_stress * g;
      cell_saturation += c.saturation;
      cell_conductivity += c.conductivity;
      ++cells;
      for (int d = 0; d < Dim; ++d) {
        if ((corner >> d) & 1 || c.face_saturation[d] < 0) continue;
        saturation[d] += c.face_saturation[d];
        conductivity[d] += c.face_conductivity[d];
        gradient[d] += c.face_gradient[d];
        ++faces[d];
      }
    }
    const double a = node.liquid_mass, b = node.solid_mass;
    const double n = pores / volume;
    const double occupancy = std::min(1.0, node.skeleton_volume / volume);
    const double phi = a / (density_ * volume), w = std::min(1.0, occupancy / 0.1);
    Vector<Dim> solid_before = node.solid_momentum / b;
    Vector<Dim> liquid_before = node.liquid_momentum / a;
    for (int d = 0; d < Dim; ++d) {
      const double s = faces[d] > 0 ? saturation[d] / faces[d] : cell_saturation / cells;
      const double k = faces[d] > 0 ? conductivity[d] / faces[d] : cell_conductivity / cells;
      node.head_gradient[d] = faces[d] > 0 ? gradient[d] / faces[d] : 0;
      const double f_l = a * gravity_[d] + phi * force[d];
      const double f_s = node.solid_force[d] + skeleton_force[d] +
                         w * (soil_force[d] - phi * force[d]) +
                         (1 - w) * occupancy * (soil_force[d] - n * s * force[d]);
      const double drag = a / density_ *
                          vadose::drag::coefficient<double>(soil_.material.drag, n, s, k,
                                                            soil_.material.unit_weight);
      const double q = dt_ * drag;
      const double r_l = a * liquid_before[d] + dt_ * f_l;
      const double r_s = b * solid_before[d] + dt_ * f_s;
      if (node.fixed[d]) {
        node.solid[d] = 0;
        node.liquid[d] = r_l / (a + q);
      } else {
        const double det = a * b + q * (a + b);
        node.liquid[d] = ((b + q) * r_l + q * r_s) / det;
        node.solid[d] = ((a + q) * r_s + q * r_l) / det;
      }
      if (node.fixed[d]) solid_before[d] = 0;  // walls mirror
      if (node.wall[d]) node.liquid[d] = liquid_before[d] = 0;
      node.relative[d] = n * (node.liquid[d] - node.solid[d]);
      node.drive[d] =
          node.relative[d] * (density_ / (n * dt_) + s * soil_.material.unit_weight / k);
    }
    node.solid_change = node.solid - solid_before;
    node.liquid_change = node.liquid - liquid_before;
  }

  const PairNode<Dim>& corner_node(const int (&i)[Dim], int corner) const {
    int j[Dim];
    for (int d = 0; d < Dim; ++d) j[d] = i[d] + ((corner >> d) & 1);
    return nodes_[grid_.number(j)];
  }

  // Volume rate of the skeleton; fluxes through the lower faces.
  void find_fluxes(PairCell<Dim>& c, const int (&i)[Dim]) {
    c.rate = 0;
    for (int corner = 0; corner < corners; ++corner)
      c.rate += corner_gradient(corner).dot(corner_node(i, corner).solid);
    for (int axis = 0; axis < Dim; ++axis) {
      c.face_flux[axis] = 0;
      if (c.face_saturation[axis] < 0) continue;
      double drive = 0, mean = 0;
      for (int corner = 0; corner < corners; ++corner) {
        if ((corner >> axis) & 1) continue;
        drive += corner_node(i, corner).drive[axis] / (corners / 2);
        mean += corner_node(i, corner).head_gradient[axis] / (corners / 2);
      }
      const double s = c.face_saturation[axis], k = c.face_conductivity[axis];
      const double h = c.face_gradient[axis];
      const double n = h > 0 ? c.porosity : below(i, axis).porosity;
      const auto mobility = [&](double inertia) {
        if (!(s > 0 && k > 0)) return 0.0;
        return 1 / (inertia * density_ / (n * s * dt_) + soil_.material.unit_weight / k);
      };
      c.face_flux[axis] =
          std::pow(grid_.h, Dim - 1) * (mobility(1) * drive - mobility(4) * (h - mean));
    }
  }

  // Calls f(water that enters, cell it comes from) for the faces of a cell.
  template <class F>
  void for_inflows(PairCell<Dim>& c, const int (&i)[Dim], F&& f) {
    const auto see = [&](double flux, const PairCell<Dim>& from) {
      const double dm = dt_ * density_ * flux;
      if (std::abs(dm) >= 16 * 2.2e-16 * std::min(c.water, from.water)) f(dm, from);
    };
    for (int axis = 0; axis < Dim; ++axis) {
      if (i[axis] > 0) see(c.face_flux[axis], below(i, axis));
      if (i[axis] + 1 == grid_.cells[axis]) continue;
      int j[Dim];
      for (int d = 0; d < Dim; ++d) j[d] = i[d] + (d == axis ? 1 : 0);
      const PairCell<Dim>& above = cells_[grid_.number(j)];
      see(-above.face_flux[axis], above);
    }
  }
  void find_gain(PairCell<Dim>& c, const int (&i)[Dim]) {
    c.gain = 0;
    for_inflows(c, i, [&](double dm, const PairCell<Dim>&) { c.gain += dm; });
  }

  // Change of the pressure as foretold: by gained water, squeezed pores, and retention that changes.
  void predict(PairCell<Dim>& c) {
    const double n = c.porosity;
    double squeeze = c.saturation;
    if (c.pressure < 0)
      squeeze += n * (1 - n) *
                 vadose::swrc::porosity_slope<double>(soil_.material.retention, -c.pressure, n);
    c.change = (c.gain / density_ - c.rate * dt_ * squeeze * c.pores / n) / c.storage;
  }

  // Of the water of every cell, with the new velocities of its points.
  void mean_velocities() {
    for (auto& c : cells_) c.momentum.setZero();
    for (const auto& w : water_) cell_at(w.position).momentum += w.mass * w.velocity;
    for (auto& c : cells_)
      if (c.pores > 0) c.velocity = c.momentum / c.water;
  }
  void find_momentum_gain(PairCell<Dim>& c, const int (&i)[Dim]) {
    Vector<Dim> momentum = Vector<Dim>::Zero();
    for_inflows(c, i, [&](double dm, const PairCell<Dim>& from) {
      if (dm > 0) momentum += dm * (from.velocity - c.velocity);
    });
    c.momentum_gain = momentum / (c.water + c.gain);
  }

  void strain(Point<Dim>& p) {
    const auto list = grid_.gimp_nodes(p.position, p.half_size);
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int a = 0; a < list.count; ++a)
      gradient.template topLeftCorner<Dim, Dim>() +=
          nodes_[list.node[a]].solid * list.gradient[a].transpose();
    const double rate = cell_at(p.position).rate;
    rotate(gradient, dt_, p.stress);
    const Eigen::Matrix3d increment =
        0.5 * dt_ * (gradient + gradient.transpose()) +
        dt_ * (rate - gradient.trace()) / 3 * Eigen::Matrix3d::Identity();
    sand_.update(increment, p.stress, p.plastic_strain);
    p.volume =
        std::min(p.volume * std::exp(dt_ * rate), p.mass / soil_.material.solid_density / 0.3);
    wave2_ = std::max(wave2_, soil_.p_wave_modulus * p.volume / p.mass);
    for (int d = 0; d < Dim; ++d) p.stretch[d] = std::exp(dt_ * gradient(d, d));
  }

  void move(Point<Dim>& p) {
    const auto list = grid_.gimp_nodes(p.position, p.half_size);
    Vector<Dim> velocity = Vector<Dim>::Zero(), change = Vector<Dim>::Zero();
    for (int a = 0; a < list.count; ++a) {
      velocity += list.value[a] * nodes_[list.node[a]].solid;
      change += list.value[a] * nodes_[list.node[a]].solid_change;
    }
    p.velocity = keep_ * (p.velocity + change) + (1 - keep_) * velocity;
    p.position += dt_ * velocity;
    stretch_half_size(p.half_size, p.stretch);
    speed2_ = std::max(speed2_, velocity.squaredNorm());
  }
  void stretch_half_size(Vector<Dim>& half, const Vector<Dim>& stretch) const {
    for (int d = 0; d < Dim; ++d)
      half[d] = std::clamp(half[d] * stretch[d], 1e-3 * grid_.h, 0.5 * grid_.h);
  }

  // New velocity of the water of a point.
  void drive(Water<Dim>& w) {
    const auto list = grid_.hat_nodes(w.position);
    Vector<Dim> velocity = Vector<Dim>::Zero(), change = Vector<Dim>::Zero();
    for (int a = 0; a < list.count; ++a) {
      velocity += list.value[a] * nodes_[list.node[a]].liquid;
      change += list.value[a] * nodes_[list.node[a]].liquid_change;
    }
    w.velocity = keep_ * (w.velocity + change) + (1 - keep_) * velocity;
  }

  // Its part in what its cell gives, with its own velocity, or receives.
  void exchange(Water<Dim>& w) {
    const auto& c = cell_at(w.position);
    const double pores = w.porosity * w.volume;
    double given = 0, taken = 0;
    if (c.gain < 0) {
      given = c.gain * w.mass / c.water;
    } else if (c.pressure >= 0) {
      taken = c.gain * pores / c.pores;
    } else {
      const double room = density_ * c.pores - c.water;
      taken =
          room > c.gain ? c.gain * (density_ * pores - w.mass) / room : c.gain * pores / c.pores;
    }
    if (c.pressure >= 0) {
      const double lacks = c.water * pores / c.pores - w.mass;
      if (std::abs(lacks) > 1e-14 * w.mass) taken += 0.05 * lacks;
    }
    const double rest = w.mass + given, after = rest + taken;
    w.velocity = (rest * w.velocity + taken * c.velocity) / after + c.momentum_gain;
    w.mass = after;
    w.pressure = c.pressure + hydrostatic(c.centroid, w.position) + c.change;
  }

  // The water of a point rides with the skeleton.
  void carry(Water<Dim>& w) {
    const auto list = grid_.gimp_nodes(w.position, w.half_size);
    Vector<Dim> velocity = Vector<Dim>::Zero(), stretch;
    Eigen::Matrix<double, Dim, Dim> gradient = Eigen::Matrix<double, Dim, Dim>::Zero();
    for (int a = 0; a < list.count; ++a) {
      velocity += list.value[a] * nodes_[list.node[a]].solid;
      gradient += nodes_[list.node[a]].solid * list.gradient[a].transpose();
    }
    const double grow = std::min(std::exp(dt_ * cell_at(w.position).rate), (1 - w.porosity) / 0.3);
    w.volume *= grow;
    w.porosity = 1 - (1 - w.porosity) / grow;
    for (int d = 0; d < Dim; ++d) stretch[d] = std::exp(dt_ * gradient(d, d));
    stretch_half_size(w.half_size, stretch);
    w.position += dt_ * velocity;
    speed2_ = std::max(speed2_, velocity.squaredNorm());
  }

  Grid<Dim> grid_;
  std::vector<PairNode<Dim>> nodes_;
  std::vector<PairCell<Dim>> cells_;
  std::vector<Point<Dim>> points_;
  std::vector<Water<Dim>> water_;
  vadose::Soil<M> soil_;
  Sand sand_;
  Vector<Dim> gravity_;
  double density_, bulk_modulus_, pic_rate_, courant_, displacement_cap_;
  double dt_ = 0, keep_ = 1, wave2_ = 0, speed2_ = 0;
};

}  // namespace naive
