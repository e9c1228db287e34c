#include "core/mesh/repair/inside_out.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_repair.h"

namespace homolog {

namespace {

/// Whether faces look inward. What a surface encloses is known for sure only where it is closed.
bool looks_inward(const Mesh& mesh) {
  const double volume_mm3 = 1000 * enclosed_volume_ml(mesh);
  if (!(volume_mm3 < 0)) return false;
  constexpr double least_round = 0.01;  // a ball is 1, a sheet 0
  const double area_mm2 = surface_area_mm2(mesh);
  return mesh.topology->closed() ||
         36 * std::numbers::pi * volume_mm3 * volume_mm3 > least_round * area_mm2 * area_mm2 * area_mm2;
}

}  // namespace

std::optional<std::string> inside_out(const Mesh& mesh) {
  const std::string remedy = " (it is inside out), so its volume counts as negative; turn it by repair-mesh";
  if (looks_inward(mesh)) return "its faces look inward" + remedy;
  if (mesh.topology->components() == 1) return std::nullopt;
  const std::vector<Mesh> parts = parts_of(mesh);
  std::vector<Box> boxes;
  for (const Mesh& part : parts) boxes.push_back(bounds_of(part.points));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (!looks_inward(parts[p])) continue;
    bool is_cavity = false;
    for (std::size_t q = 0; q < parts.size(); ++q) is_cavity = is_cavity || (q != p && boxes[q].contains(boxes[p]));
    if (!is_cavity) return "the faces of one of its parts look inward" + remedy;
  }
  return std::nullopt;
}

}  // namespace homolog
