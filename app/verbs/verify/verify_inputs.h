#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "app/verbs/verb.h"

namespace homolog {

/// The error about a file whose record does not have the form that it should have; without the file's name.
Error damaged_record();

/// An input that a record names, and where it lies now.
struct FoundInput {
  std::string name, sha256;
  std::uintmax_t bytes = 0;
  std::filesystem::path path;  ///< empty: nowhere in the folder
};

/// The inputs that records name, looked for by what they hold: names and folders may have changed.
class FoundInputs {
 public:
  /// Looks through a folder and all below it. A file is compared where its size is right; a case also where it is
  /// longer, since it has only grown behind the lines that the record is of. Errors: a record that is damaged, the
  /// folder cannot be read, cancelled.
  static Result<FoundInputs> find(const Json& options, const std::filesystem::path& folder, Progress& progress);

  const std::vector<FoundInput>& all() const { return inputs_; }
  /// The base names of those that are not there.
  std::vector<std::string> missing() const;

  /// Lays an INPUT of the record as `folder`/NAME, with the files that it names where it looks for them. Gives its
  /// path. Errors: a name that leads out of `room`; the system refuses.
  Result<std::filesystem::path> lay(const Json& input, const std::filesystem::path& folder,
                                    const std::filesystem::path& room) const;

 private:
  Result<void> lay_at(const Json& input, const std::filesystem::path& at, const std::filesystem::path& room) const;
  const FoundInput* of(const Json& file) const;

  std::vector<FoundInput> inputs_;
};

}  // namespace homolog
