#include "core/model/shapes/doubtful_shapes.h"

#include <string_view>

#include "core/adapt/judge_fit.h"
#include "core/base/encoding/json.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_faults.h"

namespace homolog {

namespace {

constexpr std::string_view doubt_key = "homolog.doubtful ";

}  // namespace

std::string doubt_comment(const std::string& reason) {
  return std::string(doubt_key) + nlohmann::json(reason).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void forget_doubt(MeshFile& mesh) {
  std::erase_if(mesh.comments, [](const std::string& comment) { return comment.starts_with(doubt_key); });
}

std::string doubt_of_shape(const MeshFile& mesh) {
  for (const std::string& comment : mesh.comments) {
    if (!comment.starts_with(doubt_key)) continue;
    const auto reason = read_json<nlohmann::json>(comment.substr(doubt_key.size()));
    return reason && reason->is_string() ? reason->get<std::string>() : "its fit is doubtful";
  }
  const auto sound = sound_mesh(mesh);
  if (!sound) return {};
  // What is missing of a partial fit is in doubt by nature.
  if (mesh.doubt_mm && mesh.doubt_mm->size() == mesh.points.rows() && !mesh.outlier) {
    const double mean_mm = mesh.doubt_mm->mean();
    if (mean_mm > much_doubt_mm(surface_area_mm2(*sound))) {
      char text[160];
      std::snprintf(text, sizeof text, "where along the surface its vertices belong is in doubt by %.1f mm on average",
                    mean_mm);
      return text;
    }
  }
  const MeshFaults faults = mesh_faults(*sound);
  return faults.intersections + faults.turned > 0 ? "it has " + faults.words() : std::string();
}

std::vector<std::string> doubt_warnings(const std::vector<DoubtfulShape>& shapes, bool left_out) {
  std::vector<std::string> sentences;
  for (const DoubtfulShape& one : shapes)
    sentences.push_back(one.name + ": " + one.reason + (left_out ? " (left out)" : ""));
  if (!shapes.empty() && !left_out)
    sentences.push_back(std::to_string(shapes.size()) + (shapes.size() == 1 ? " shape is" : " shapes are") +
                        " in doubt; repair them, or leave them out with --without-doubtful");
  return sentences;
}

}  // namespace homolog
