#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/picking/shown_mesh.h"
#include "app/editor/state/label_map_layer.h"
#include "app/editor/state/state.h"
#include "core/session/session_thread.h"

namespace homolog {

/// The label map that is shown over the image.
struct ShownLabels : LabelMapLayer {
  std::string name;
  std::filesystem::path file;
  std::optional<int> frame;           ///< the frame of a cine that a map of one frame belongs to
  std::vector<LabelMapLayer> layers;  ///< the map's layers
  std::size_t layer = 0;              ///< the layer that is shown

  /// In all layers.
  std::size_t label_count() const {
    std::size_t count = 0;
    for (const LabelMapLayer& one : layers) count += one.values.size();
    return count;
  }
  bool is_of(int of_frame) const { return !frame || *frame == of_frame; }
  /// Why nothing is fitted to it at a frame of the case; empty where something may be.
  std::string refusal_at(int of_frame) const;
  /// "Label 3", or "kidney_left (3)" where it has a name.
  std::string label_name(int label) const;
};

/// Whether there are edits of a case that has no file of its own.
bool has_unsaved_edits(const Snapshot& snapshot);

/// The case on the screen: its session, what of it is shown, and the label map over it. Belongs to the window's thread.
class ShownCase {
 public:
  /// `wake` is called from the session's thread when there is something new.
  explicit ShownCase(std::function<void()> wake) : wake_(std::move(wake)) {}
  ~ShownCase() { close(); }

  /// Closes the case that is shown, and shows another. The label map goes where the image is another. Returns what
  /// close() does.
  [[nodiscard]] Refusals start(EditSession session);
  /// Waits until what was asked for is done and on the disk. Whoever snaps must have been told to stop. Returns what
  /// was refused and nobody was told of yet.
  Refusals close();
  bool is_open() const { return session_ != nullptr; }

  SessionThread& session() const { return *session_; }
  /// As it was taken in last.
  const Snapshot& snapshot() const { return *snapshot_; }
  /// The document that is shown: with the preview, at the frame that plays.
  const Document& document() const { return *displayed_; }
  const std::shared_ptr<const Document>& displayed() const { return displayed_; }
  /// The document as it is done, without a preview, at the frame that is shown: what works on the case starts from it.
  std::shared_ptr<const Document> done() const;
  /// The mesh of `document`, for pointing and drawing.
  ShownMesh& mesh() const { return mesh_; }
  /// Counts the cases that were on the screen.
  std::uint64_t number() const { return number_; }
  /// As its file holds it: the case may have mirrored it. If the case saved it as painted, that file.
  const std::shared_ptr<const Template>& loaded_template() const { return loaded_template_; }
  /// Goes on with the template of a file to which the case saved it.
  void adopt_template(std::shared_ptr<const Template> saved) { loaded_template_ = std::move(saved); }
  /// Whether the case's template is that of the other side than the one that was loaded.
  bool template_is_mirrored() const;
  /// Writes down which grey values are shown, where they are other than the case says.
  void keep_window(const EditorState& state);
  /// Writes down how the case is looked at, where that is other than the case says.
  void keep_looks(const EditorState& state);
  /// What keep_looks would write; nothing where it is as the case says, or could not be written.
  std::optional<KeptLooks> looks_to_write(const EditorState& state);

  /// Takes in what the session did. Removes from the state what refers to things that are gone. True if the shown mesh
  /// moved, or what is in doubt of it changed.
  bool update_snapshot(EditorState& state);
  /// Whether the session has nothing more to do, and all of it was taken in.
  bool at_rest() const { return !session_->busy() && snapshot_ == session_->snapshot(); }

  const ShownLabels& labels() const { return labels_; }
  /// The case's file names them from then on.
  void show_labels(ShownLabels labels);
  void close_labels() { show_labels({}); }
  /// Shows another layer of the map. Layers are counted from 0.
  void show_labels_layer(std::size_t layer) {
    if (layer >= labels_.layers.size()) return;
    static_cast<LabelMapLayer&>(labels_) = labels_.layers[layer];
    labels_.layer = layer;
  }
  /// The map belongs to another frame of the cine.
  void set_labels_frame(int frame) {
    if (labels_.frame) labels_.frame = frame;
  }
  /// The map where it belongs to the frame that is shown, else null.
  std::shared_ptr<const Volume> labels_here() const {
    return labels_.is_of(displayed_->frame) ? labels_.volume : nullptr;
  }

 private:
  void keep_on_disk(EditorState& state);

  std::function<void()> wake_;
  std::unique_ptr<SessionThread> session_;
  std::uint64_t number_ = 0;
  std::shared_ptr<const Snapshot> snapshot_;
  std::shared_ptr<const Document> displayed_;
  std::shared_ptr<const Document> tried_to_keep_;  ///< the last for which a journal was asked
  std::shared_ptr<const Template> loaded_template_;
  std::optional<std::array<double, 2>> kept_window_;  ///< as the case says, or as an image is shown at first
  std::optional<KeptLooks> begun_looks_;              ///< as the case began on the screen
  std::optional<KeptLooks> written_looks_;            ///< the last that were written, whether the disk took them or not
  ShownLabels labels_;
  mutable ShownMesh mesh_;  ///< the mesh of `displayed_`, with what is remembered of it
};

/// A few sentences on what became of the case's file, and why edits came to nothing. If there are many at once, the
/// first says what is wrong with the disk, the last how it stands now.
std::vector<std::string> told(const Refusals& refused);

/// Puts the case's file among the recent ones, where it is one of its own.
void remember_case(EditorState& state, const Snapshot& snapshot);

}  // namespace homolog
