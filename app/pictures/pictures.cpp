#include "app/pictures/pictures.h"

#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

// What is shown together: shapes, modes, a mode that plays.

namespace homolog {

Result<Vec3> direction_from_name(const std::string& name) {
  const std::array<std::pair<const char*, Vec3>, 6> names{{{"anterior", -Vec3::UnitY()},
                                                           {"posterior", Vec3::UnitY()},
                                                           {"left", Vec3::UnitX()},
                                                           {"right", -Vec3::UnitX()},
                                                           {"superior", Vec3::UnitZ()},
                                                           {"inferior", -Vec3::UnitZ()}}};
  for (const auto& [known, direction] : names) {
    if (name == known) return direction;
  }
  std::istringstream in(name);
  Vec3 direction;
  char comma1 = 0, comma2 = 0;
  if (in >> direction[0] >> comma1 >> direction[1] >> comma2 >> direction[2] && comma1 == ',' && comma2 == ',' &&
      (in >> std::ws).eof() && direction.allFinite() && direction.norm() > 1e-9) {
    return direction.normalized();
  }
  return fail("--view " + name, "is no direction; use anterior, posterior, left, right, superior, inferior or x,y,z");
}

Result<MadePicture> correspondence_picture(const std::vector<Mesh>& shapes, const std::vector<std::string>& names,
                                           const MontageOptions& options) {
  std::vector<MontageCell> cells;
  for (std::size_t k = 0; k < shapes.size(); ++k) cells.push_back({shapes[k], names[k], options.from, {}});
  return montage(cells, 0, options);
}

Result<std::vector<MontageCell>> cells_of_modes(const ShapeModel& model, int modes, const Vec3& from) {
  if (!model.topology) return fail("", "is a model of points without faces, which cannot be drawn");
  std::vector<MontageCell> cells;
  for (Eigen::Index mode = 0; mode < std::min<Eigen::Index>(modes, model.modes()); ++mode) {
    const auto add = [&](double deviations, std::string name) {
      cells.push_back({{model.topology, mode_shape(model, mode, deviations)}, std::move(name), from, {}});
    };
    add(-3, "Mode " + std::to_string(mode + 1) +
                ", \xe2\x88\x92"
                "3\xe2\x88\x9a\xce\xbb");
    add(0, "mean");
    add(3, "+3\xe2\x88\x9a\xce\xbb");
  }
  if (cells.empty()) return fail("", "has no mode to show");
  return cells;
}

std::vector<MontageCell> playing_mode(const ShapeModel& model, Eigen::Index mode, int frames, const Vec3& from) {
  std::vector<MontageCell> cells;
  for (int k = 0; k < frames; ++k) {
    const double deviations = 3 * std::sin(2 * std::numbers::pi * k / frames);
    cells.push_back(
        {{model.topology, mode_shape(model, mode, deviations)}, "Mode " + std::to_string(mode + 1), from, {}});
  }
  return cells;
}

Result<MadePicture> modes_picture(const ShapeModel& model, int modes, const MontageOptions& options) {
  const auto cells = cells_of_modes(model, modes, options.from);
  if (!cells) return fail(cells.error());
  return montage(*cells, 3, options);
}

}  // namespace homolog
