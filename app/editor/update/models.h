#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/editor/update/commands.h"
#include "app/editor/work/models/build_study_model.h"
#include "app/editor/work/worker.h"
#include "core/session/session_thread.h"

namespace homolog {

/// The Models mode's background work: rebuilds the model when its shapes change, measures it, and keeps the study's
/// file up to date.
class Models {
 public:
  /// `wake` is called from any thread when there is something new.
  explicit Models(std::function<void()> wake)
      : builder_(wake), checker_(wake), evaluator_(wake), phantoms_(wake), exporter_(wake), files_(std::move(wake)) {}

  void open_study(const ModelsState& models, const std::filesystem::path& path);
  void new_study(const ModelsState& models, const std::filesystem::path& path);
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
  /// The export of shapes that goes on.
  std::optional<RunningJob> exports_running() const { return exporter_.running(); }
  /// Gives up reading a study, or making a case of `subject`, where that runs. A file in writing is written whole.
  void cancel_file(const std::string& subject) { files_.cancel_running(subject); }
  /// Says what became of the work on files, and does what it leaves to do; true where there was some.
  bool take_files(EditorState& state, Outbox& out);
  /// Writes the study's file where it is not up to date: again, where that failed. True where that was to be done.
  bool write_if_changed(const ModelsState& models);
  /// Whether the study's file is to be written as soon as no other file is.
  bool has_to_write(const ModelsState& models) const { return written_revision_ != models.kept.revision; }
  /// The study's file whose writing failed last; empty where none did since.
  const std::filesystem::path& unwritten() const { return unwritten_; }
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
  struct Checked {
    std::shared_ptr<const StudyModel> model;
    std::shared_ptr<const Suspicions> suspicions;
    KnownDoubts known;
  };
  void build(EditorState& state, const Snapshot& snapshot);
  /// Looks for what is suspicious in the model that is shown, unless that is done or goes on.
  void check(const ModelsState& models);
  /// True where there is something new to draw.
  bool take_checked(ModelsState& models);
  void show_built(EditorState& state, StudyModelBuilt built);
  /// Shows the sentences that were not shown yet; of many only the first, and how many more there are.
  void tell_once(EditorState& state, const std::vector<std::string>& sentences, bool error);
  /// The work that work on files leaves to do here, on the window's thread.
  using Then = std::function<void(EditorState&, Outbox&)>;
  struct FileDone {
    std::filesystem::path path;  ///< the study's file where that was to be written
    Result<void> written;
    Then then;  ///< empty where nothing is left to do
  };
  bool study_is_written(const ModelsState& models) const {
    return written_revision_ == models.kept.revision && unwritten_.empty();
  }
  void write_study_file(const ModelsState& models);
  void queue_writing(const ModelsState& models, const std::filesystem::path& path, Then then);
  /// Runs on the worker's thread. The function that it gives runs on the window's, and shows the study through `shows`.
  static Result<FileDone> read_of(const std::filesystem::path& path, const Progress& progress, Models& shows);
  void show_study(EditorState& state, StudyRead read, const std::filesystem::path& path);
  void repair_case(const StudyCase& one, const OpenCaseOfStudy& command, EditorState& state);
  /// Puts the case that was made of a mesh into the study in the mesh's place, and opens it.
  static void take_repair_case(const OpenCaseOfStudy& command, const std::filesystem::path& mesh_file,
                               const std::filesystem::path& case_file, EditorState& state, Outbox& out);

  Worker<StudyModelBuilt> builder_;
  Worker<Checked> checker_;
  Worker<Evaluated> evaluator_;
  Worker<std::filesystem::path> phantoms_;
  Worker<std::string> exporter_;  ///< gives the sentence that says what was written
  Worker<FileDone> files_;        ///< the study's file and the cases made beside it, in order; none is dropped
  std::shared_ptr<const StudyModel> checked_;  ///< the last that was asked to be checked
  KnownDoubts known_doubts_;
  std::uint64_t built_revision_ = 0;
  std::uint64_t written_revision_ = 0;  ///< the last that was asked to be written
  std::filesystem::path unwritten_;     ///< see unwritten(); the next change, or closing, tries again
  Alignment built_alignment_ = Alignment::similarity;
  std::shared_ptr<const Document> built_document_;  ///< the open case's document, where it is one of the study's
  std::vector<std::string> told_;                   ///< sentences about this study that were shown already
};

/// A study's file that is not there yet.
std::filesystem::path new_study_file();
/// Gives the study on the screen such a file, and says where it lies and how it gets another place.
void start_new_study(EditorState& state);

}  // namespace homolog
