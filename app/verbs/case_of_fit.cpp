#include "app/verbs/case_of_fit.h"

#include "core/base/files/paths.h"
#include "core/case/actions/frames.h"
#include "core/case/actions/points.h"
#include "core/model/shapes/shape_folder.h"
#include "core/session/case_file.h"
#include "core/session/case_keeping.h"

namespace homolog {

namespace fs = std::filesystem;

Result<StudyCase> write_case_of_fit(const FittedCase& fitted, const fs::path& folder,
                                    std::vector<std::string>& warnings) {
  StudyCase one;
  one.name = fitted.name;
  one.file = absolute_path(folder / (fitted.name + case_extension));
  one.from_scan = !fitted.image.empty();
  one.state = CaseState::in_work;
  if (!fitted.labels.empty()) one.labels = absolute_path(fitted.labels);
  one.doubt = fitted.doubt;
  std::error_code ignored;
  if (fs::exists(one.file, ignored) && was_worked_on(one.file)) {
    warnings.push_back(one.file.string() + ": was worked on, so it stays as it is; move it away to begin anew");
    return one;
  }
  one.frame = fitted.frame;
  const Template& the_template = *fitted.template_of_file;
  if (fitted.points.rows() != the_template.points.rows())
    return fail(fitted.name, "has " + std::to_string(fitted.points.rows()) + " vertices where the template has " +
                                 std::to_string(the_template.points.rows()) +
                                 "; give the template that it was fitted "
                                 "with");
  const std::string image = fitted.image.empty() ? "" : absolute_path(fitted.image).string();
  Document document = new_document(image, fitted.grid, fitted.template_of_file);
  document.hold_landmarks();
  auto session = create_case(std::move(document), one.file, {}, fitted.record);
  if (!session) return fail(session.error());
  if (fitted.mirrored)
    if (auto turned = session->apply(MirrorTemplate{}); !turned) return fail(turned.error());
  if (fitted.frame)
    if (auto shown = session->apply(SetFrame{*fitted.frame}); !shown) return fail(shown.error());
  SetPoints edit = points_edit(*session->document().view(), fitted.points, FoundBy::fit, fitted.placement);
  if (fitted.doubt_mm.size() > 0) edit.doubt_mm = doubt_on_grid(fitted.doubt_mm);
  if (fitted.outlier.size() > 0) edit.outlier = std::make_shared<const VertexScalars>(fitted.outlier);
  FitFigures figures = fitted.figures.value_or(FitFigures{});
  figures.mesh = mesh_hash(*edit.points);
  if (auto applied = session->apply(std::move(edit)); !applied) return fail(applied.error());
  if (auto noted = session->apply(Note{"fit", {}, {}, figures}); !noted) return fail(noted.error());
  if (!one.labels.empty())
    if (auto named = name_labels(*session, one.labels); !named) return fail(named.error());
  return one;
}

std::shared_ptr<const Volume> grid_of(const Volume& volume) {
  auto grid = std::make_shared<Volume>();
  grid->geometry = volume.geometry;
  grid->frames = volume.frames;
  grid->frame_seconds = volume.frame_seconds;
  grid->modality = volume.modality;
  grid->series_uid = volume.series_uid;
  grid->resampled = volume.resampled;
  grid->range_min = volume.range_min;
  grid->range_max = volume.range_max;
  return grid;
}

}  // namespace homolog
