#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/editor/scene/gallery_pictures.h"
#include "app/editor/update/commands.h"
#include "app/editor/work/latest_wins.h"
#include "core/case/session_thread.h"

namespace homolog {

/// The Models mode's background work: makes the model anew when its shapes change, measures it, keeps the study's file
/// as the study is.
class Models {
 public:
  /// `wake` is called from any thread when there is something new.
  explicit Models(std::function<void()> wake) : builder_(wake), evaluator_(wake), phantoms_(wake), exporter_(wake) {}

  void run(const ModelsCommand& command, EditorState& state, const Snapshot& snapshot, Outbox& out);
  /// Takes in what the threads did, and starts what is due. True where there is something new to draw.
  bool update(EditorState& state, const Snapshot& snapshot, double seconds);
  /// Seconds until something moves by itself.
  std::optional<double> next_move_seconds(const ModelsState& state) const;
  /// Puts the cross-hair on the landmark that the case was opened for, with the Slide tool in hand,
  /// and looks at it in the 3D view. Gives the frame that has to be shown for it, where another one is.
  static std::optional<int> show_repair(EditorState& state, const Snapshot& snapshot);
  /// Waits for everything that is due.
  void settle(EditorState& state, const Snapshot& snapshot);

 private:
  struct Evaluated {
    std::shared_ptr<const StudyModel> model;
    Evaluation evaluation;
  };
  void build(EditorState& state, const Snapshot& snapshot);
  void take_built(EditorState& state, StudyModelBuilt built);
  /// Says what was not said yet; of many sentences the first, and how many more there are.
  void tell_once(EditorState& state, const std::vector<std::string>& sentences, bool error);
  void write_study_file(EditorState& state);
  void open_study(EditorState& state, const std::filesystem::path& path);
  void open_case(const OpenCaseOfStudy& command, EditorState& state, const Snapshot& snapshot, Outbox& out);
  void export_shapes(const ExportShapes& command, const ModelsState& models);

  LatestWins<StudyModelBuilt> builder_;
  LatestWins<Evaluated> evaluator_;
  LatestWins<std::filesystem::path> phantoms_;
  LatestWins<std::filesystem::path> exporter_;
  std::uint64_t built_revision_ = 0, written_revision_ = 0;
  Alignment built_alignment_ = Alignment::similarity;
  std::shared_ptr<const Document> built_document_;  ///< of the open case, where it is one of the study's
  std::vector<std::string> told_;                   ///< sentences about this study that were shown already
};

}  // namespace homolog
