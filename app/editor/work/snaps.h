#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/editor/state/outcomes.h"
#include "core/assist/assist.h"
#include "core/base/processes/progress.h"
#include "core/session/session_thread.h"

namespace homolog {

/// How a snap goes by the settings.
SnapOptions snap_options_of(const SnapSettings& settings);

/// A snap as the settings say. If it fails, the mesh stays as it is and there is no error.
Compute snap_compute(const SnapArea& region, const SnapSettings& settings);

/// Snaps the case's mesh to its image on the session's thread, each snap one edit. The latest wins: one that still
/// runs is given up.
class Snaps {
 public:
  /// `of`: the structure; empty: the first.
  void start(SessionThread& session, std::optional<SnapArea> region, const SnapSettings& settings, bool joined = false,
             const std::string& of = {});
  void cancel();
  bool busy() const;
  /// The findings of the latest snap, once.
  std::optional<SnapFound> take();

 private:
  struct Box;
  std::shared_ptr<Box> box_;
};

}  // namespace homolog
