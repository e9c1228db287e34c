#include "core/mesh/formats/ply_comments.h"

#include <cmath>
#include <optional>

#include "core/base/encoding/json.h"
#include "core/base/files/file_record.h"
#include "core/base/pictures/colour.h"
#include "core/base/text/text.h"
#include "core/mesh/formats/text.h"

namespace homolog::formats {

namespace {

constexpr std::string_view landmark_key = "homolog.landmark ";
constexpr std::string_view stiffness_base_key = "homolog.stiffness_base ";
constexpr std::string_view region_key = "homolog.region ";

std::optional<Landmark> landmark_from(std::string_view text) {
  const auto json = read_json<nlohmann::json>(text).value_or(nlohmann::json());
  if (!json.is_object()) return std::nullopt;
  const auto name = json.find("name"), position = json.find("position");
  if (name == json.end() || !name->is_string() || position == json.end() || !position->is_array() ||
      position->size() != 3)
    return std::nullopt;
  Landmark landmark{name->get<std::string>(), {}};
  if (landmark.name.size() > longest_name) return std::nullopt;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(*position)[k].is_number()) return std::nullopt;
    landmark.position[static_cast<Eigen::Index>(k)] = (*position)[k].get<double>();
  }
  return landmark;
}

std::optional<Region> region_from(std::string_view text) {
  const auto json = read_json<nlohmann::json>(text).value_or(nlohmann::json());
  if (!json.is_object() || !json.contains("name") || !json["name"].is_string() || !json.contains("factor") ||
      !json["factor"].is_number() || !(json["factor"].get<double>() > 0))
    return std::nullopt;
  Region region{json["name"].get<std::string>(), json["factor"].get<double>(), {}};
  if (region.name.size() > longest_name) return std::nullopt;
  if (const auto colour = json.find("colour"); colour != json.end() && colour->is_string()) {
    if (const auto rgb = colour_from_hex(colour->get<std::string>())) region.colour = *rgb;
  }
  return region;
}

}  // namespace

void keep_comment(std::string_view comment, MeshFile& mesh) {
  if (is_record_line(comment)) return;  // it is of the file that was read, not of what is made of it
  if (comment.starts_with(landmark_key)) {
    if (auto landmark = landmark_from(comment.substr(landmark_key.size()))) {
      mesh.landmarks.push_back(std::move(*landmark));
      return;
    }
    mesh.warnings.push_back("a landmark cannot be read and is kept as a comment: " + excerpt(comment));
  }
  if (comment.starts_with(region_key) && mesh.regions.list.size() < 255) {
    if (auto region = region_from(comment.substr(region_key.size()))) {
      mesh.regions.list.push_back(std::move(*region));
      return;
    }
    mesh.warnings.push_back("a region cannot be read and is kept as a comment: " + excerpt(comment));
  }
  if (comment.starts_with(stiffness_base_key)) {
    const auto base = to_number<double>(comment.substr(stiffness_base_key.size()));
    if (base && *base > 0 && std::isfinite(*base)) {
      mesh.stiffness_base = *base;
      return;
    }
    mesh.warnings.push_back("the stiffness base is no positive number and is kept as a comment");
  }
  mesh.comments.emplace_back(comment);
}

void write_comments(const MeshFile& mesh, std::string& bytes) {
  if (mesh.stiffness) {
    bytes.append("comment ").append(stiffness_base_key);
    append_number(mesh.stiffness_base, bytes);
    bytes += '\n';
  }
  for (const Region& region : mesh.regions.list) {
    const nlohmann::ordered_json json = {
        {"name", region.name}, {"factor", region.factor}, {"colour", hex_of(region.colour)}};
    bytes.append("comment ").append(region_key);
    bytes.append(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)).append("\n");
  }
  for (const Landmark& landmark : mesh.landmarks) {
    const nlohmann::ordered_json json = {{"name", landmark.name},
                                         {"position", std::vector(landmark.position.begin(), landmark.position.end())}};
    bytes.append("comment ").append(landmark_key);
    bytes.append(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)).append("\n");
  }
  for (const std::string& comment : mesh.comments) bytes.append("comment ").append(comment).append("\n");
  bytes += record_lines("comment ", mesh.record);
}

}  // namespace homolog::formats
