#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/work/worker.h"
#include "core/adapt/image/appearance.h"
#include "core/model/shapes/study.h"

namespace homolog {

/// The look of the organ's boundary in the cases of a study that are done: their images are read again for it.
struct LearnedAppearance {
  std::shared_ptr<const Appearance> appearance;  ///< null where no case could be learned from
  int cases = 0;
  std::vector<std::string> left_out;  ///< a sentence for each case that could not be read
};

/// Case files of the study that are done and can be learned from, but for `open_file`: at most the first eight.
std::vector<StudyCase> cases_to_learn(const Study& study, const std::filesystem::path& open_file);

/// Learns from `cases` those whose mesh has `vertices`.
LearnedAppearance learn_appearance(const std::vector<StudyCase>& cases, Eigen::Index vertices, Progress& progress);

/// Learns on a thread of its own. Called from the window's thread only.
class StudyAppearance {
 public:
  /// `wake` is called from the thread when it is done.
  explicit StudyAppearance(std::function<void()> wake) : work_(std::move(wake)) {}

  /// Asks for what these cases look like; nothing happens where that is known or asked for already.
  void ask(std::vector<StudyCase> cases, Eigen::Index vertices);
  void forget();
  /// Takes in what the thread did; the sentences of cases left out.
  std::vector<std::string> update();
  const LearnedAppearance& learned() const { return learned_; }
  bool busy() const { return work_.busy(); }
  double fraction() const { return work_.fraction(); }
  void finish() { work_.finish(); }

 private:
  std::vector<std::string> asked_;  ///< files and frames
  Eigen::Index vertices_ = 0;
  LearnedAppearance learned_;
  Worker<LearnedAppearance> work_;
};

}  // namespace homolog
