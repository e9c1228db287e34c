#include "core/template/other_side.h"

#include <algorithm>

#include "core/base/text/side_of_name.h"

namespace homolog {

FacedNames names_of_other_side(const FacedNames& faced) {
  FacedNames other{{}, faced.kept};
  for (std::size_t from = 0; from <= faced.labels.size();) {
    const std::size_t to = std::min(faced.labels.find(',', from), faced.labels.size());
    const std::string name = faced.labels.substr(from, to - from), exchanged = name_of_other_side(name);
    other.labels += (from > 0 ? "," : "") + (exchanged.empty() ? name : exchanged);
    from = to + 1;
  }
  return other;
}

MeshFile mirrored_with_names(const MeshFile& mesh, AnatomicalPlane plane) {
  MeshFile other = mirrored(mesh, plane);
  for (std::string& comment : other.comments)
    if (const auto faced = faced_in({comment})) comment = faced_comment(names_of_other_side(*faced));
  return other;
}

}  // namespace homolog
