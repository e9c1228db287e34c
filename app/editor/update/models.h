#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/editor/scene/gallery_pictures.h"
#include "app/editor/update/commands.h"
#include "app/editor/work/worker.h"
#include "core/case/session_thread.h"

namespace homolog {

/// The Models mode's background work: makes the model anew when its shapes change, measures it, keeps the study's file
/// as the study is.
class Models {
 public:
  /// `wake` is called from any thread when there is something new.
  explicit Models(std::function<void()> wake)
      : builder_(wake), evaluator_(wake), phantoms_(wake), exporter_(wake), files_(std::move(wake)) {}

  void open_study(const std::filesystem::path& path);
  void new_study(const std::filesystem::path& path);
  void save_study_as(const ModelsState& models, const std::filesystem::path& path);
  void open_phantom_study(Organ organ);
  void open_case(const OpenCaseOfStudy& command, EditorState& state, const Snapshot& snapshot, Outbox& out);
  void export_shapes(const ExportShapes& command, const ModelsState& models);
  void start_evaluation(const ModelsState& models);
  void cancel_evaluation() { evaluator_.cancel(); }
  /// Takes in what the threads did, and starts what is due. True where there is something new to draw.
  bool update(EditorState& state, const Snapshot& snapshot, double seconds, Outbox& out);
  /// Whether something that was asked for is not done yet.
  bool busy() const;
  /// The study's file or a case's that is being read or written.
  std::optional<RunningJob> files_running() const { return files_.running(); }
  /// Gives up opening a study, where one is being read.
  void cancel_file() { files_.cancel_running(); }
  /// Seconds until something moves by itself.
  std::optional<double> next_move_seconds(const ModelsState& state) const;
  /// Puts the cross-hair on the vertex that the case was opened for, with the Slide tool in hand,
  /// and looks at it in the 3D view. Gives the frame that has to be shown for it, where another one is.
  static std::optional<int> show_repair(EditorState& state, const Snapshot& snapshot);
  /// Waits for everything that is due.
  void settle(EditorState& state, const Snapshot& snapshot, Outbox& out);
  /// Writes the study's file where it is not up to date, and waits for that; the sentences of what went wrong.
  std::vector<std::string> close(ModelsState& models);

 private:
  struct Evaluated {
    std::shared_ptr<const StudyModel> model;
    Evaluation evaluation;
  };
  void build(EditorState& state, const Snapshot& snapshot);
  void take_built(EditorState& state, StudyModelBuilt built);
  /// Shows the sentences that were not shown yet; of many only the first, and how many more there are.
  void tell_once(EditorState& state, const std::vector<std::string>& sentences, bool error);
  /// What work on files leaves to do here, on the window's thread.
  using Then = std::function<void(EditorState&, Outbox&)>;
  bool study_is_written(const ModelsState& models) const { return written_revision_ == models.study_revision; }
  void write_study_file(const ModelsState& models);
  Result<Then> read_of(const std::filesystem::path& path, const Progress& progress);
  void take_study(EditorState& state, StudyRead read, const std::filesystem::path& path);
  bool take_files(EditorState& state, Outbox& out);
  void repair_case(const StudyCase& one, const OpenCaseOfStudy& command, EditorState& state);

  Worker<StudyModelBuilt> builder_;
  Worker<Evaluated> evaluator_;
  Worker<std::filesystem::path> phantoms_;
  Worker<std::filesystem::path> exporter_;
  Worker<Then> files_;  ///< the study's file and the cases made beside it, in order; none is dropped
  std::uint64_t built_revision_ = 0, written_revision_ = 0;
  Alignment built_alignment_ = Alignment::similarity;
  std::shared_ptr<const Document> built_document_;  ///< of the open case, where it is one of the study's
  std::vector<std::string> told_;                   ///< sentences about this study that were shown already
};

/// A study's file that is not there yet.
std::filesystem::path new_study_file();

}  // namespace homolog
