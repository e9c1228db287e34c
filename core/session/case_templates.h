#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/case/action.h"

namespace homolog {

/// The templates of a case's structures, beside the first one's, which the first line names. Each is read once; copies
/// share what was read. Belongs to one thread.
class CaseTemplates {
 public:
  /// The folder to which lines name templates. It stays as it is where the case goes on elsewhere. None: the case has
  /// no file yet, and lines name whole paths.
  const std::optional<std::filesystem::path>& folder() const { return folder_; }
  void set_folder(std::optional<std::filesystem::path> folder) { folder_ = std::move(folder); }
  /// Whether a line names a template. The first line says so.
  bool named() const { return named_; }
  void set_named(bool named) { named_ = named; }

  /// Sets the folder of the case; templates that are not in their place are looked for there too.
  void set_case_folder(std::filesystem::path folder) { case_folder_ = std::move(folder); }

  /// The template of a source, read where it is not known yet. If the file is gone, as after a folder was moved, the
  /// end of its path is looked for under the case's folder and the one above. Errors: load_template's.
  Result<std::shared_ptr<const Template>> load(const std::string& source) const;
  /// One that is read already.
  void add(std::shared_ptr<const Template> the_template) const;

  /// A source as a line names it. And back.
  std::string name_of(const std::string& source) const;
  std::string source_of(const std::string& name) const;
  /// A step as it can be applied: a new structure has its template and its mark. Errors: load's; the template is not
  /// the one that the step was made with.
  Result<void> complete(EditStep& step) const;
  /// The warnings about templates that steps were completed with, each once.
  std::vector<std::string> take_warnings() const { return std::exchange(known_->warnings, {}); }
  /// A step of a line, whose source becomes that from here. And the step as its line has it.
  EditStep from_line(EditStep step) const;
  EditStep to_line(EditStep step) const;

 private:
  struct Known {
    std::map<std::string, std::shared_ptr<const Template>> templates;
    std::vector<std::string> warnings;
  };
  std::optional<std::filesystem::path> folder_;
  std::filesystem::path case_folder_;  ///< empty: not known
  bool named_ = false;
  std::shared_ptr<Known> known_ = std::make_shared<Known>();
};

}  // namespace homolog
