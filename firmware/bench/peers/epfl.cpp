// How long one modulated velocity takes EPFL's C++ library, measured as `benches/percentiles.rs` measures ours.
//
// Library: https://github.com/epfl-lasa/dynamic_obstacle_avoidance_cpp (measured at commit 19e7c04, with two Eigens: libigl/eigen 1f05f51 of
// 2017 and the slower 3.3.90 of 2019, eigen-git-mirror 36b9596). From this folder, with Eigen as <eigen3/...>:
//
//   git clone https://github.com/epfl-lasa/dynamic_obstacle_avoidance_cpp peer
//   g++ -O3 -march=native -DNDEBUG -std=c++17 -I peer/include epfl.cpp \
//     peer/src/{Modulation,Agent,Environment}.cpp peer/src/Obstacle/*.cpp peer/src/State/*.cpp peer/src/Utils/MathTools.cpp \
//     peer/src/Utils/ObstacleGeneration/Aggregation.cpp -o epfl && ./epfl
//
// Its obstacles can draw themselves, by matplotlibcpp and so Python, which has to be found as well. Where it was measured there is no Python to
// link: Utils/Plotting/matplotlibcpp.hpp was replaced by one whose `plot` and `text` do nothing. Nothing that is timed draws.
//
// The library counts in three dimensions: the ellipsoids are long across the plane in which everything else happens.

#include "DynamicObstacleAvoidance/Agent.hpp"
#include "DynamicObstacleAvoidance/Environment.hpp"
#include "DynamicObstacleAvoidance/Modulation.hpp"
#include "DynamicObstacleAvoidance/Obstacle/Ellipsoid.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <vector>

using namespace DynamicObstacleAvoidance;

namespace {

constexpr std::size_t kCalls = 1'000'000;
constexpr std::size_t kPositions = 256;

template <class Call>
std::vector<double> times(Call call) {
  std::vector<double> all;
  all.reserve(kCalls);
  for (std::size_t i = 0; i < kCalls; ++i) {
    const auto start = std::chrono::steady_clock::now();
    call(i);
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
    all.push_back(taken.count());
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

int main() {
  std::printf("%9s %11s %9s\n", "obstacles", "median, ns", "p99.9");
  double used = 0.0;  // so that no call is left out
  for (const int obstacles : {1, 2, 5, 10, 20, 50}) {
    std::mt19937 random(obstacles);
    std::uniform_real_distribution<double> place(-1.0, 1.0), axis(0.02, 0.08), angle(-3.0, 3.0);
    Environment environment(false);
    for (int i = 0; i < obstacles; ++i) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle(random), Eigen::Vector3d::UnitZ()));
      auto body = std::make_shared<Ellipsoid>("body" + std::to_string(i),
                                              State(Eigen::Vector3d(place(random), place(random), 0.0), turn));
      body->set_axis_lengths(Eigen::Array3d(axis(random), axis(random), 1.0));
      environment.add_obstacle(body);
    }
    environment.update();

    Agent agent{State(Eigen::Vector3d::Zero())};
    std::vector<Eigen::Vector3d> positions;
    while (positions.size() < kPositions) {
      const Eigen::Vector3d position(place(random), place(random), 0.0);
      agent.set_position(position);
      bool outside = true;
      for (const auto& body : environment.get_obstacle_list()) {
        outside = outside && body->compute_distance_to_agent(agent) > 1.0;
      }
      if (outside) positions.push_back(position);
    }

    const double reading = times([](std::size_t) {})[kCalls / 2];
    const auto all = times([&](std::size_t i) {
      const Eigen::Vector3d& position = positions[i % kPositions];
      agent.set_position(position);
      agent.set_linear_velocity(-position);
      used += Modulation::modulate_velocity(agent, environment).norm();
    });
    std::printf("%9d %11.0f %9.0f\n", obstacles, all[kCalls / 2] - reading, all[kCalls * 999 / 1000] - reading);
  }
  return used > 0.0 ? 0 : 1;
}
