#include "core/template_making/template_file.h"

namespace homolog {

using Json = nlohmann::ordered_json;

MeshFile template_file(const Mesh& mesh, const Json& provenance) {
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology;
  file.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Ones(mesh.points.rows()));
  file.comments.push_back("homolog.units mm");
  file.comments.push_back("homolog.provenance " + provenance.dump(-1, ' ', false, Json::error_handler_t::replace));
  return file;
}

void mark_cut(MeshFile& file, const std::vector<std::int32_t>& vertices) {
  add_region(file.regions, {cut_region, 1, {176, 120, 40}}, vertices, static_cast<std::size_t>(file.points.rows()));
}

std::string genus_text(const GenusRule& rule) {
  switch (rule.kind) {
    case GenusRule::Kind::automatic:
      return "auto";
    case GenusRule::Kind::keep:
      return "keep";
    case GenusRule::Kind::number:
      break;
  }
  return std::to_string(rule.genus);
}

Json provenance_of(const std::string& source, const MaskTemplateOptions& options) {
  const auto radius = [](const std::optional<double>& mm) { return mm ? Json(*mm) : Json("auto"); };
  return {{"source", source},
          {"label", options.label},
          {"frame", options.frame},
          {"vertices", options.vertices},
          {"closing_mm", radius(options.closing_mm)},
          {"opening_mm", radius(options.opening_mm)},
          {"genus", genus_text(options.genus)}};
}

Json provenance_of(const std::string& source, const TubeTemplateOptions& options) {
  Json provenance{{"source", source},       {"label", options.label},     {"frame", options.frame},  {"tube", true},
                  {"rings", options.rings}, {"sectors", options.sectors}, {"capped", options.capped}};
  if (options.outer_label) provenance["outer_label"] = *options.outer_label;
  if (options.axis) provenance["axis"] = {options.axis->x(), options.axis->y(), options.axis->z()};
  if (options.base_and_apex) {
    const auto& [base, apex] = *options.base_and_apex;
    provenance["base"] = {base.x(), base.y(), base.z()};
    provenance["apex"] = {apex.x(), apex.y(), apex.z()};
  }
  return provenance;
}

}  // namespace homolog
