#include "core/session/checkpoint.h"

#include <bit>

#include "core/base/encoding/hash.h"
#include "core/base/encoding/json.h"
#include "core/case/actions/fields.h"
#include "core/deform/deformer.h"
#include "core/deform/stroke_kinds.h"
#include "core/mesh/construction/icosphere.h"
#include "core/session/case_lines.h"
#include "core/session/checkpoint_members.h"
#include "core/session/sound_document.h"

namespace homolog {

namespace {

using Json = nlohmann::ordered_json;

/// Raise it where a member is written otherwise or gets another meaning, and where a line gives another result that
/// name_of_solver does not show. A new member needs no other number: a checkpoint without it is passed over.
constexpr int checkpoint_format = 3;

/// Names the solver by its result on a small fixed problem. Where a later solver gives other points, checkpoints of an
/// earlier one do not hold.
const std::string& name_of_solver() {
  static const std::string name = [] {
    const Mesh ball = icosphere(2, 40);
    StrokeStart start{.topology = ball.topology, .stiffness_base = default_stiffness_base};
    start.placed = start.reference = start.points = std::make_shared<const Points>(ball.points);
    start.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Ones(ball.points.rows()));
    const Vec3 top(0, 0, 40);
    Hash hash;
    for (const StrokeKind& kind : stroke_kinds) {
      const Stroke stroke{.tool = kind.tool, .at = top, .to = top + Vec3(4, 0, 12), .sigma_mm = 15};
      const auto outcome = Deformer().stroke(start, stroke, Pass::commit);
      if (!outcome) continue;
      for (const double mm : outcome->points.reshaped()) hash.add(std::bit_cast<std::uint64_t>(mm));
    }
    return hash.hex();
  }();
  return name;
}

/// A checksum of all that a replay starts from.
std::uint32_t start_check(const Document& start) {
  const auto bytes_of = [](const auto& array) {
    return std::string_view(reinterpret_cast<const char*>(array.data()),
                            static_cast<std::size_t>(array.size()) * sizeof(*array.data()));
  };
  std::uint32_t check = 0;
  for (const auto& structure : start.structures) {
    check = CaseLines::checked(check, bytes_of(structure->the_template->points));
    check = CaseLines::checked(check, bytes_of(structure->the_template->topology->triangles()));
  }
  return CaseLines::checked(check, members_to_json(start, start, {}).dump() + std::to_string(start.scan.frames()));
}

}  // namespace

std::optional<std::string> checkpoint_line(const Document& start, const Document& document, std::uint32_t lines_check,
                                           const CaseTemplates& templates) {
  if (!start.view() || document.structures.empty()) return std::nullopt;
  std::string line;
  try {
    const Json checkpoint{{"format", checkpoint_format},
                          {"solver", name_of_solver()},
                          {"start", start_check(start)},
                          {"lines", lines_check},
                          {"document", members_to_json(start, document, templates)}};
    line = Json{{"checkpoint", checkpoint}}.dump();
  } catch (const Unusable&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;  // a name that is no UTF-8
  }
  const auto read = read_checkpoint(line, start, lines_check, templates);
  if (!read || !same_document(*read, document)) return std::nullopt;
  return line;
}

std::optional<Document> read_checkpoint(const std::string& line, const Document& start, std::uint32_t lines_check,
                                        const CaseTemplates& templates) {
  if (!start.view()) return std::nullopt;
  const auto json = read_json<Json>(line);
  if (!json) return std::nullopt;
  try {
    const Json& checkpoint = json->at("checkpoint");
    if (checkpoint.at("format") != checkpoint_format || checkpoint.at("solver") != name_of_solver() ||
        checkpoint.at("start") != start_check(start) || checkpoint.at("lines") != lines_check)
      return std::nullopt;
    Document document = members_from_json(checkpoint.at("document"), start, templates);
    return is_sound(document) ? std::optional(std::move(document)) : std::nullopt;
  } catch (const Unusable&) {
    return std::nullopt;
  } catch (const Unreadable&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace homolog
