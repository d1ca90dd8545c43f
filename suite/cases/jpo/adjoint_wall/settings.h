/// The walls around the training range that the neural adjoint is given, and
/// the experiments that they are varied on.
#pragma once

#include <array>
#include <string>

namespace physinv::adjoint_wall {

/// Sharpness of the softplus, and weight in median losses at the start.
struct Wall {
  const char* id;     ///< of the method na-ID
  const char* title;  ///< sharpness, weight
  double gamma, weight;

  std::string method() const { return std::string("na-") + id; }
};
inline constexpr std::array<Wall, 5> kWalls{
    {{"g20-w10", "20, 10 (the suite's)", 20, 10},
     {"g20-w1", "20, 1", 20, 1},
     {"g20-w01", "20, 0.1", 20, 0.1},
     {"g100-w10", "100, 10", 100, 10},
     {"g5-w100", "5, 100", 5, 100}}};

struct Study {
  const char *name, *varied, *title;
  double velocity_spread = 0;  ///< of billiards' labelled samples
  Index labels = 1;            ///< for each problem of a set
};
inline constexpr std::array<Study, 7> kStudies{
    {{"studies/billiards-wall",
      "jpo/billiards",
      "Billiards, wall of the neural adjoint",
      0.5},
     {"studies/billiards-wall-8n",
      "jpo/billiards",
      "Billiards, wall of the neural adjoint, 8 n samples",
      0.5,
      8},
     {"studies/billiards-wall-32n",
      "jpo/billiards",
      "Billiards, wall of the neural adjoint, 32 n samples",
      0.5,
      32},
     {"studies/billiards-wall-narrow",
      "jpo/billiards",
      "Billiards, wall of the neural adjoint, samples spread by 0.1",
      0.1},
     {"studies/wave-packet-wall",
      "jpo/wave-packet",
      "Wave packet, wall of the neural adjoint"},
     {"studies/wave-packet-wall-8n",
      "jpo/wave-packet",
      "Wave packet, wall of the neural adjoint, 8 n samples",
      0,
      8},
     {"studies/wave-packet-wall-32n",
      "jpo/wave-packet",
      "Wave packet, wall of the neural adjoint, 32 n samples",
      0,
      32}}};

}  // namespace physinv::adjoint_wall
