// SPDX-License-Identifier: MIT
#pragma once

// The material point method as one writes it down first: an array of points with Eigen members in no
// order, an array of nodes over the whole box, and in every pass, for every point, the list of its
// nodes with their weights. The same physics as the library's dry model with a Drucker-Prager
// skeleton, GIMP and FLIP; it starts from the points of a Solver.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Dense>

#include <vadose/policy/law/drucker_prager.hpp>
#include <vadose/solver/solver.hpp>

namespace naive {

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;

template <int Dim>
struct Point {
  std::int64_t id = 0;
  Vector<Dim> position, velocity, half_size;
  Vector<Dim> stretch = Vector<Dim>::Ones();  // of the half sizes in this step
  double mass = 0, volume = 0;
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();  // tension positive [Pa]
  double plastic_strain = 0;
};

template <int Dim>
struct Node {
  double mass = 0;
  Vector<Dim> momentum, force, velocity, change;
  bool fixed[Dim] = {};  // no velocity along the axis
};

// Nodes around a point.
template <int Dim>
struct NodeList {
  static constexpr int most = Dim == 2 ? 9 : 27;
  int count = 0;
  std::size_t node[most];
  double value[most];
  Vector<Dim> gradient[most];
};

// Regular grid over a box; node 0 of each axis is at its lower end.
template <int Dim>
struct Grid {
  Vector<Dim> origin;
  double h = 1;
  int cells[Dim];

  std::size_t size() const {
    std::size_t n = 1;
    for (int d = 0; d < Dim; ++d) n *= static_cast<std::size_t>(cells[d] + 1);
    return n;
  }
  std::size_t number(const int (&i)[Dim]) const {
    std::size_t n = 0;
    for (int d = Dim - 1; d >= 0; --d)
      n = n * static_cast<std::size_t>(cells[d] + 1) + static_cast<std::size_t>(i[d]);
    return n;
  }

  // Mean of the hat function of a node at distance u over [u - l, u + l], l <= 1/2, and its slope.
  static double mean_hat(double u, double l) {
    const double a = std::abs(u);
    if (a < l) return 1 - (a * a + l * l) / (2 * l);
    if (a < 1 - l) return 1 - a;
    if (a < 1 + l) return (1 + l - a) * (1 + l - a) / (4 * l);
    return 0;
  }
  static double mean_slope(double u, double l) {
    const double a = std::abs(u), sign = u < 0 ? -1 : 1;
    if (a < l) return -u / l;
    if (a < 1 - l) return -sign;
    if (a < 1 + l) return -sign * (1 + l - a) / (2 * l);
    return 0;
  }

  // Three nodes along each axis; a node beyond a wall has the velocity 2 v_wall - v_next.
  NodeList<Dim> gimp_nodes(const Vector<Dim>& x, const Vector<Dim>& half) const {
    int first[Dim];
    double w[Dim][3], g[Dim][3];
    for (int d = 0; d < Dim; ++d) {
      const double u = (x[d] - origin[d]) / h;
      first[d] = static_cast<int>(std::floor(u - 0.5));
      for (int i = 0; i < 3; ++i) {
        w[d][i] = mean_hat(u - (first[d] + i), half[d] / h);
        g[d][i] = mean_slope(u - (first[d] + i), half[d] / h) / h;
      }
      if (first[d] < 0) fold(w[d], 0, 2), fold(g[d], 0, 2);
      if (first[d] + 2 > cells[d]) fold(w[d], 2, 0), fold(g[d], 2, 0);
    }
    return tensor_product<3>(first, w, g);
  }

  // Two nodes along each axis.
  NodeList<Dim> hat_nodes(const Vector<Dim>& x) const {
    int first[Dim];
    double w[Dim][2], g[Dim][2];
    for (int d = 0; d < Dim; ++d) {
      const double u = (x[d] - origin[d]) / h;
      first[d] = static_cast<int>(std::floor(u));
      w[d][1] = u - first[d];
      w[d][0] = 1 - w[d][1];
      g[d][1] = 1 / h;
      g[d][0] = -1 / h;
    }
    return tensor_product<2>(first, w, g);
  }

  static void fold(double (&w)[3], int outside, int next) {
    w[1] += 2 * w[outside];
    w[next] -= w[outside];
    w[outside] = 0;
  }

  template <int N>
  NodeList<Dim> tensor_product(const int (&first)[Dim], const double (&w)[Dim][N],
                               const double (&g)[Dim][N]) const {
    NodeList<Dim> list;
    int i[Dim] = {};
    while (true) {
      int at[Dim];
      double value = 1;
      bool exists = true;
      for (int d = 0; d < Dim; ++d) {
        at[d] = first[d] + i[d];
        exists = exists && at[d] >= 0 && at[d] <= cells[d];
        value *= w[d][i[d]];
      }
      if (exists) {
        list.node[list.count] = number(at);
        list.value[list.count] = value;
        for (int d = 0; d < Dim; ++d) {
          list.gradient[list.count][d] = g[d][i[d]];
          for (int e = 0; e < Dim; ++e)
            if (e != d) list.gradient[list.count][d] *= w[e][i[e]];
        }
        ++list.count;
      }
      int d = 0;
      while (d < Dim && ++i[d] == N) i[d++] = 0;
      if (d == Dim) return list;
    }
  }
};

// Drucker-Prager with a cone matched in plane strain, no mobilisation: closed-form return.
struct Sand {
  double bulk_modulus, shear_modulus, slope, intercept, dilation, mean_limit, measure;

  explicit Sand(const vadose::law::DruckerPrager& law)
      : bulk_modulus(law.elastic.bulk_modulus()), shear_modulus(law.elastic.shear_modulus()) {
    const double sin_phi = std::sin(law.friction_angle), sin_psi = std::sin(law.dilation_angle);
    const double factor = std::sqrt(1 + sin_psi * sin_psi / 3) / (1 + sin_phi * sin_psi / 3);
    slope = factor * sin_phi;
    intercept = factor * law.cohesion * std::cos(law.friction_angle);
    dilation = std::sqrt(1 + sin_psi * sin_psi / 3) / (1 + sin_psi * sin_psi / 3) * sin_psi;
    mean_limit = std::min(law.tensile_strength, intercept / std::max(slope, 1e-30));
    measure = law.mobilisation.measure == vadose::law::ShearMeasure::engineering
                  ? 1
                  : std::numbers::inv_sqrt3;
  }

  void update(const Eigen::Matrix3d& strain, Eigen::Matrix3d& stress, double& plastic) const {
    const double volume = strain.trace();
    stress += 2 * shear_modulus * strain +
              (bulk_modulus - 2 * shear_modulus / 3) * volume * Eigen::Matrix3d::Identity();
    const double mean = stress.trace() / 3;
    const Eigen::Matrix3d deviator = stress - mean * Eigen::Matrix3d::Identity();
    const double shear = std::sqrt(0.5 * deviator.squaredNorm());
    double new_mean = mean, new_shear = shear;
    const double excess = shear + slope * mean - intercept;
    if (excess > 0) {
      const double multiplier = excess / (shear_modulus + bulk_modulus * slope * dilation);
      new_mean -= bulk_modulus * dilation * multiplier;
      new_shear -= shear_modulus * multiplier;
    }
    if (new_mean > mean_limit) {
      new_mean = mean_limit;
      new_shear = std::min(shear, std::max(intercept - slope * mean_limit, 0.0));
    }
    if (shear > 0)
      stress = new_shear / shear * deviator + new_mean * Eigen::Matrix3d::Identity();
    else
      stress = new_mean * Eigen::Matrix3d::Identity();
    plastic += measure / shear_modulus * (shear - new_shear);
  }
};

// Jaumann's rotation over a step, by the orthogonal matrix (I - W dt/2)^-1 (I + W dt/2).
inline void rotate(const Eigen::Matrix3d& gradient, double dt, Eigen::Matrix3d& stress) {
  const Eigen::Matrix3d a = 0.25 * dt * (gradient - gradient.transpose());
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d r = (one - a).inverse() * (one + a);
  stress = (r * stress * r.transpose()).eval();
}

// The solid points of a solver, shuffled.
template <int Dim, class Points>
std::vector<Point<Dim>> take_solid(const Points& points) {
  using namespace vadose;
  std::vector<Point<Dim>> taken;
  points.for_each([&](std::size_t b, int l) {
    Point<Dim> p;
    p.id = static_cast<std::int64_t>(points.at(field::id, b)[l]);
    for (int d = 0; d < Dim; ++d) {
      p.position[d] = points.at(field::position, b, d)[l];
      p.velocity[d] = points.at(field::velocity, b, d)[l];
      p.half_size[d] = points.at(field::half_size, b, d)[l];
    }
    for (int d = 0; d < 3; ++d) p.stress(d, d) = points.at(field::bishop_stress, b, d)[l];
    p.stress(0, 1) = p.stress(1, 0) = points.at(field::bishop_stress, b, 3)[l];
    if constexpr (Dim == 3) {
      p.stress(1, 2) = p.stress(2, 1) = points.at(field::bishop_stress, b, 4)[l];
      p.stress(0, 2) = p.stress(2, 0) = points.at(field::bishop_stress, b, 5)[l];
    }
    p.mass = points.at(field::mass, b)[l];
    p.volume = points.at(field::volume, b)[l];
    taken.push_back(p);
  });
  std::shuffle(taken.begin(), taken.end(), std::mt19937_64(1));
  return taken;
}

// A run of dry soil in a box whose floor is fixed and whose other walls are smooth.
template <int Dim>
class DryRun {
 public:
  // Takes points and numbers over from a solver that has not stepped yet.
  template <class Solver>
  explicit DryRun(const Solver& solver)
      : sand_(solver.state().soils[0].material.skeleton),
        density_(solver.state().soils[0].material.solid_density),
        gravity_(solver.state().gravity),
        pic_rate_(solver.state().transfer.pic_rate),
        courant_(solver.state().options.courant),
        displacement_cap_(solver.state().options.displacement_cap),
        modulus_(solver.state().soils[0].p_wave_modulus) {
    grid_.origin = solver.state().grid.origin();
    grid_.h = solver.state().grid.cell_size();
    for (int d = 0; d < Dim; ++d) grid_.cells[d] = solver.state().grid.cells()[d];
    nodes_.resize(grid_.size());
    mark_walls();
    points_ = take_solid<Dim>(solver.solid());
    wave2_ = modulus_ / (density_ * (1 - solver.state().soils[0].material.porosity));
  }

  const std::vector<Point<Dim>>& points() const { return points_; }

  void step() {
    const double h = grid_.h;
    double dt = courant_ * h / std::sqrt(wave2_);
    if (speed2_ > 0) dt = std::min(dt, displacement_cap_ * h / std::sqrt(speed2_));
    for (auto& node : nodes_) {
      node.mass = 0;
      node.momentum.setZero();
      node.force.setZero();
    }
    for (const auto& p : points_) {
      const auto list = grid_.gimp_nodes(p.position, p.half_size);
      for (int a = 0; a < list.count; ++a) {
        nodes_[list.node[a]].mass += list.value[a] * p.mass;
        nodes_[list.node[a]].momentum += list.value[a] * p.mass * p.velocity;
      }
    }
    for (const auto& p : points_) {
      const auto list = grid_.gimp_nodes(p.position, p.half_size);
      for (int a = 0; a < list.count; ++a)
        nodes_[list.node[a]].force +=
            list.value[a] * p.mass * gravity_ -
            p.volume * (p.stress.template topLeftCorner<Dim, Dim>() * list.gradient[a]);
    }
    for (auto& node : nodes_) {
      if (!(node.mass > 0)) {
        node.velocity.setZero();
        node.change.setZero();
        continue;
      }
      Vector<Dim> before = node.momentum / node.mass;
      node.velocity = before + dt * node.force / node.mass;
      for (int d = 0; d < Dim; ++d)
        if (node.fixed[d]) node.velocity[d] = before[d] = 0;  // walls mirror
      node.change = node.velocity - before;
    }
    wave2_ = speed2_ = 0;
    for (auto& p : points_) strain(dt, p);
    const double keep = std::exp(-pic_rate_ * dt);
    for (auto& p : points_) move(dt, keep, p);
  }

 private:
  void mark_walls() {
    int i[Dim] = {};
    for (auto& node : nodes_) {
      for (int d = 0; d < Dim; ++d)
        node.fixed[d] = i[d] == 0 || i[d] == grid_.cells[d] || i[Dim - 1] == 0;
      int d = 0;
      while (d < Dim && ++i[d] > grid_.cells[d]) i[d++] = 0;
    }
  }

  void strain(double dt, Point<Dim>& p) {
    const auto list = grid_.gimp_nodes(p.position, p.half_size);
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int a = 0; a < list.count; ++a)
      gradient.template topLeftCorner<Dim, Dim>() +=
          nodes_[list.node[a]].velocity * list.gradient[a].transpose();
    rotate(gradient, dt, p.stress);
    sand_.update(0.5 * dt * (gradient + gradient.transpose()), p.stress, p.plastic_strain);
    p.volume *= std::exp(dt * gradient.trace());
    wave2_ = std::max(wave2_, modulus_ * p.volume / p.mass);
    for (int d = 0; d < Dim; ++d) p.stretch[d] = std::exp(dt * gradient(d, d));
  }

  void move(double dt, double keep, Point<Dim>& p) {
    const auto list = grid_.gimp_nodes(p.position, p.half_size);
    Vector<Dim> velocity = Vector<Dim>::Zero(), change = Vector<Dim>::Zero();
    for (int a = 0; a < list.count; ++a) {
      velocity += list.value[a] * nodes_[list.node[a]].velocity;
      change += list.value[a] * nodes_[list.node[a]].change;
    }
    p.velocity = keep * (p.velocity + change) + (1 - keep) * velocity;
    p.position += dt * velocity;
    for (int d = 0; d < Dim; ++d)
      p.half_size[d] = std::clamp(p.half_size[d] * p.stretch[d], 1e-3 * grid_.h, 0.5 * grid_.h);
    speed2_ = std::max(speed2_, velocity.squaredNorm());
  }

  Grid<Dim> grid_;
  std::vector<Node<Dim>> nodes_;
  std::vector<Point<Dim>> points_;
  Sand sand_;
  double density_;
  Vector<Dim> gravity_;
  double pic_rate_, courant_, displacement_cap_, modulus_;
  double wave2_ = 0, speed2_ = 0;
};

}  // namespace naive
