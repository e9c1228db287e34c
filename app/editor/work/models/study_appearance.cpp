#include "app/editor/work/models/study_appearance.h"

#include <utility>

#include "core/session/case_file.h"

namespace homolog {

namespace {

constexpr std::size_t most_cases = 8;

/// Errors: no image, no mesh in the frame, another template.
Result<void> learn_case(const StudyCase& one, const Document& document, Eigen::Index vertices, Appearance& appearance) {
  const int frame = one.frame.value_or(document.frame);
  const Structure* structure = document.structure(one.structure);
  const Shape* shape = structure != nullptr ? structure->shape(frame) : nullptr;
  if (!document.scan.image || shape == nullptr)
    return fail(one.name, "has no image with a mesh on it, so nothing can be learned from it");
  if (shape->points->rows() != vertices) return fail(one.name, "is of another template");
  return appearance.learn(*document.scan.image, frame, {structure->the_template->topology, *shape->points});
}

}  // namespace

std::vector<StudyCase> cases_to_learn(const Study& study, const std::filesystem::path& open_file) {
  std::vector<StudyCase> cases;
  for (const StudyCase& one : study.cases)
    if (cases.size() < most_cases && one.state == CaseState::done && one.file != open_file && is_case_file(one.file))
      cases.push_back(one);
  return cases;
}

LearnedAppearance learn_appearance(const std::vector<StudyCase>& cases, Eigen::Index vertices, Progress& progress) {
  LearnedAppearance learned;
  auto appearance = std::make_shared<Appearance>();
  std::optional<Result<CaseRead>> read;
  for (std::size_t k = 0; k < cases.size() && !progress.cancelled(); ++k) {
    const auto count = static_cast<double>(cases.size());
    progress.part(static_cast<double>(k) / count, static_cast<double>(k + 1) / count);
    // Frames of one cine follow one another: its image is read once.
    if (k == 0 || cases[k].file != cases[k - 1].file) {
      ReplayOptions options;
      options.progress = &progress;
      read = read_case(cases[k].file, options);
    }
    const Result<void> done = *read ? learn_case(cases[k], (*read)->session.document(), vertices, *appearance)
                                    : Result<void>(fail(read->error()));
    learned.cases += done ? 1 : 0;
    if (!done) learned.left_out.push_back(done.error().sentence() + " (not learned from)");
  }
  if (learned.cases > 0) learned.appearance = std::move(appearance);
  return learned;
}

void StudyAppearance::ask(std::vector<StudyCase> cases, Eigen::Index vertices) {
  std::vector<std::string> asked;
  for (const StudyCase& one : cases)
    asked.push_back(one.file.string() + " " + one.structure + (one.frame ? " " + std::to_string(*one.frame) : ""));
  if (asked == asked_ && vertices == vertices_) return;
  asked_ = std::move(asked);
  vertices_ = vertices;
  learned_ = {};
  work_.start("Learning from the study", [cases = std::move(cases), vertices](Progress& progress) {
    return learn_appearance(cases, vertices, progress);
  });
}

void StudyAppearance::forget() {
  work_.cancel();
  asked_.clear();
  learned_ = {};
}

std::vector<std::string> StudyAppearance::update() {
  auto done = work_.take();
  if (!done) return {};
  if (!*done) return {done->error().sentence()};
  learned_ = std::move(**done);
  return learned_.left_out;
}

}  // namespace homolog
