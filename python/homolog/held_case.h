#pragma once

#include <atomic>
#include <string>
#include <utility>

#include "core/base/files/paths.h"
#include "core/session/session.h"
#include "python/homolog/binding.h"

namespace homolog::python {

/// A case that Python holds.
struct HeldCase {
  HeldCase(EditSession held_session, const std::filesystem::path& file)
      : session(std::move(held_session)),
        source(file.empty() ? std::string() : absolute_path(file).string()),
        is_written(session.journal() != nullptr),
        image_stamp(session.document().scan.source) {}

  EditSession session;
  std::string source;                           ///< its file, from the root; empty: it has none
  bool is_written;                              ///< its edits are in that file
  bool is_closed = false;                       ///< it has a file that takes no more edits
  FileStamp image_stamp;                        ///< the stamp of the image's file
  mutable std::shared_ptr<HeldVolume> image{};  ///< the scan, once it was asked for
  mutable std::atomic<bool> in_use{false};  ///< a call is at work on it, which may run without the interpreter's lock
};

/// Holds a case for one call, which may run without the interpreter's lock. Errors: another call holds it.
class InUse {
 public:
  explicit InUse(const HeldCase& of) : of_(of) {
    if (of.in_use.exchange(true)) refuse("case", "is at work in another call; wait until that ends");
  }
  ~InUse() { of_.in_use = false; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  const HeldCase& of_;
};

/// Errors: the case was closed, so that an edit would be in no file.
inline void check_takes_edits(const HeldCase& of) {
  if (of.is_closed) refuse("case", "is closed; open it again");
}

/// The case as it is now. It stays so, whatever other calls do to the case.
inline std::shared_ptr<const Document> document_of(const HeldCase& of) {
  const InUse held(of);
  return of.session.shared_document();
}

}  // namespace homolog::python
