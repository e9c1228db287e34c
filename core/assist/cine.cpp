#include "core/assist/cine.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/mesh/mesh_quality.h"

namespace homolog {

std::vector<int> starting_frames(const ShapeView& shown) {
  std::vector<int> frames;
  for (const auto& [frame, shape] : shown.structure.shapes)
    if (frame_is_known(*shape)) frames.push_back(frame);
  if (frames.empty()) frames.push_back(shown.frame);
  return frames;
}

Result<CineEdit> propagate_shape(const Scan& scan, const ShapeView& shown, const PropagateOptions& options) {
  if (!scan.image) return fail("", "There is no cine to propagate through; open one first.");
  const std::vector<int> start = starting_frames(shown);
  PropagateOptions from = options;
  from.known.clear();
  for (const int frame : start) {
    const Shape& shape = *shown.structure.shape(frame);
    from.known[frame] = *shape.points;
    from.missing_share = std::max(from.missing_share, missing_share_of(shown.the_template(), shape));
  }
  const Mesh mesh{shown.the_template().topology, from.known.at(start.front())};
  auto done = propagate(*scan.image, start.front(), mesh, *shown.paint().stiffness, from);
  if (!done) return fail(done.error());
  CineEdit edit;
  const auto add = [&](int frame, const Points& points, const char* by) -> SetPoints& {
    return edit.actions.emplace_back(points_edit(shown, frame, points, by));
  };
  // The mesh that all come from is a person's choice from now on.
  if (!frame_is_known(*shown.structure.shape(start.front()))) add(start.front(), mesh.points, "start of the cine");
  for (std::size_t f = 0; f < done->frames.size(); ++f) {
    if (from.known.contains(static_cast<int>(f))) continue;
    SetPoints& carried = add(static_cast<int>(f), done->frames[f].points, by_propagation);
    carried.doubt = done->frames[f].doubt;
    done->frames[f].points = *carried.points;
  }
  edit.result = std::move(*done);
  return edit;
}

VolumeCurve volume_curve(const Structure& structure, const VolumeCurve& before) {
  VolumeCurve curve;
  std::map<int, double> trusted;
  for (const auto& [frame, shared] : structure.shapes) {
    const Shape& shape = *shared;
    if (shape.strokes == 0) continue;
    VolumeCurve::Frame& one = curve.frames[frame];
    one.points = shape.points;
    one.known = frame_is_known(shape);
    if (!one.known)
      one.doubt = shape.doubt;
    else if (const double missing = missing_share_of(*structure.the_template, shape); missing > 0)
      one.doubt = missing_doubt(missing);
    const auto known = before.frames.find(frame);
    one.volume_ml = known != before.frames.end() && known->second.points == shape.points
                        ? known->second.volume_ml
                        : enclosed_volume_ml({structure.the_template->topology, *shape.points});
    if (one.doubt.empty()) trusted[frame] = one.volume_ml;
  }
  if (trusted.size() >= 2) curve.ejection = ejection_of(trusted);
  return curve;
}

std::string volume_table(const VolumeCurve& curve, double frame_seconds) {
  std::string table = "frame,seconds,volume_ml,known,doubt\n";
  for (const auto& [frame, one] : curve.frames) {
    char line[96];
    std::snprintf(line, sizeof line, "%d,%.4f,%.3f,%d,", frame, frame * frame_seconds, one.volume_ml,
                  one.known ? 1 : 0);
    table += line + (one.doubt.empty() ? "" : '"' + one.doubt + '"') + "\n";
  }
  return table;
}

}  // namespace homolog
