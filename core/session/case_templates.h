#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

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

  /// The template of a source, read where it is not known yet. Errors: load_template's.
  Result<std::shared_ptr<const Template>> load(const std::string& source) const;
  /// One that is read already.
  void add(std::shared_ptr<const Template> the_template) const;

  /// A source as a line names it. And back.
  std::string name_of(const std::string& source) const;
  std::string source_of(const std::string& name) const;
  /// A step as it can be applied: a new structure has its template. Errors: load's.
  Result<void> complete(EditStep& step) const;
  /// A step of a line, whose source becomes that from here. And the step as its line has it.
  EditStep from_line(EditStep step) const;
  EditStep to_line(EditStep step) const;

 private:
  std::optional<std::filesystem::path> folder_;
  bool named_ = false;
  std::shared_ptr<std::map<std::string, std::shared_ptr<const Template>>> known_ =
      std::make_shared<std::map<std::string, std::shared_ptr<const Template>>>();
};

}  // namespace homolog
