#include "app/verbs/mending_report.h"

#include <charconv>

#include "core/mesh/repair/mesh_faults.h"

namespace homolog {

Json json_of(const MendedFaults& mended) {
  return {{"not_finite", mended.not_finite},
          {"duplicate_vertices", mended.duplicate_vertices},
          {"unused_vertices", mended.unused_vertices},
          {"degenerate_faces", mended.degenerate_faces},
          {"duplicate_faces", mended.duplicate_faces},
          {"non_manifold_edges", mended.non_manifold_edges},
          {"non_manifold_vertices", mended.non_manifold_vertices},
          {"turned_faces", mended.turned_faces},
          {"crumbs", mended.crumbs},
          {"cavities", mended.cavities},
          {"holes", mended.holes}};
}

Json json_of(const Rebuilt& rebuilt) {
  return {{"voxel_mm", rebuilt.voxel_mm},
          {"wall_mm", rebuilt.wall_mm},
          {"closing_mm", rebuilt.closing_mm},
          {"opening_mm", rebuilt.opening_mm},
          {"genus_before", rebuilt.genus_before}};
}

GenusRule genus_rule(const std::string& text) {
  GenusRule rule;
  if (text == "auto") return rule;
  rule.kind = text == "keep" ? GenusRule::Kind::keep : GenusRule::Kind::number;
  if (rule.kind == GenusRule::Kind::number) std::from_chars(text.data(), text.data() + text.size(), rule.genus);
  return rule;
}

void add_holes_option(CLI::App& verb, std::string& holes) {
  verb.add_option("--holes", holes,
                  "Of a surface. small: holes with a rim of up to half its diagonal are closed; all; keep: none is")
      ->check(CLI::IsMember({"small", "all", "keep"}))
      ->capture_default_str();
}

double longest_rim_share(const std::string& holes) {
  if (holes == "keep") return -1;
  return holes == "small" ? small_rim_share : std::numeric_limits<double>::infinity();
}

void add_genus_option(CLI::App& verb, std::string& genus, const std::string& help) {
  verb.add_option("--genus", genus, help)
      ->check(CLI::IsMember({"auto", "keep"}) | CLI::Range(0, 1000))
      ->check([](const std::string& text) {
        const bool plain = text == "auto" || text == "keep" || text.find_first_not_of("0123456789") == text.npos;
        return plain ? std::string() : "is no number of tunnels; write it in digits, 2 for instance";
      })
      ->capture_default_str();
}

std::vector<std::string> faults_of(const MeshFile& file, const std::filesystem::path& path) {
  const auto topology = Topology::make(file.points.rows(), file.triangles);
  if (!topology) return {};
  const MeshFaults faults = mesh_faults({*topology, file.points});
  std::vector<std::string> sentences;
  if (faults.any())
    sentences.push_back(path.string() + ": has " + faults.words() +
                        ", so fits with it will have faults too; repair the surface, or ask for more vertices");
  if (faults.riddled())
    sentences.push_back(path.string() + ": has " + std::to_string(faults.tunnels) +
                        " tunnels, more than organs have; use --genus auto or a number, or --closing-mm");
  return sentences;
}

}  // namespace homolog
