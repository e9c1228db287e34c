#include "core/session/case_templates.h"

#include <algorithm>
#include <utility>

#include "core/base/files/paths.h"
#include "core/catalogue/catalogue.h"
#include "core/template/template_mark.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The step with its structure's source changed by `name`; another step stays as it is.
template <class Name>
EditStep with_source(EditStep step, const Name& name) {
  auto* structure = std::get_if<SetStructure>(&step.action);
  if (structure != nullptr && !structure->source.empty()) structure->source = name(structure->source);
  return step;
}

/// A file that is gone, found by the end of its path in a folder or the one above; else the source as it is.
std::string found_again(const std::string& source, const fs::path& folder) {
  std::error_code ignored;
  if (folder.empty() || !names_file(source) || fs::exists(source, ignored)) return source;
  const fs::path gone(source);
  fs::path end;
  for (auto part = gone.end(); part != gone.begin();) {
    end = end.empty() ? *--part : *--part / end;
    if (end.is_absolute()) break;
    for (const fs::path& place : {folder / end, folder.parent_path() / end})
      if (fs::exists(place, ignored)) return place.string();
  }
  return source;
}

}  // namespace

Result<std::shared_ptr<const Template>> CaseTemplates::load(const std::string& source) const {
  auto& known = known_->templates;
  if (const auto found = known.find(source); found != known.end()) return found->second;
  const std::string found_at = found_again(source, case_folder_);
  auto read = load_template(found_at);
  if (!read) return fail(read.error());
  if (found_at != source)
    known_->warnings.push_back(source + ": is not there; " + found_at + " was taken in its place");
  known.insert_or_assign(source, *read);
  return *read;
}

void CaseTemplates::add(std::shared_ptr<const Template> the_template) const {
  const std::string source = the_template->source;
  known_->templates.insert_or_assign(source, std::move(the_template));
}

Result<void> CaseTemplates::complete(EditStep& step) const {
  auto* structure = std::get_if<SetStructure>(&step.action);
  if (structure == nullptr) return {};
  if (structure->the_template) {
    structure->source = structure->the_template->source;
    add(structure->the_template);
  }
  if (structure->source.empty()) return {};
  if (!structure->the_template) {
    auto read = load(structure->source);
    if (!read) return fail(read.error());
    structure->the_template = *read;
  }
  TemplateMark mark = template_mark(*structure->the_template);
  if (structure->mark.size() == mark.size()) {
    std::ranges::copy(structure->mark, mark.begin());
    auto same = check_template_mark(mark, *structure->the_template);
    if (!same) return fail(same.error());
    auto& said = known_->warnings;
    if (!same->empty() && std::ranges::find(said, *same) == said.end()) said.push_back(std::move(*same));
  }
  structure->mark.assign(mark.begin(), mark.end());
  return {};
}

std::string CaseTemplates::name_of(const std::string& source) const {
  if (folder_) return relative_source(*folder_, source);
  return names_file(source) ? absolute_path(source).string() : source;
}

std::string CaseTemplates::source_of(const std::string& name) const {
  return folder_ ? resolved_source(*folder_, name) : name;
}

EditStep CaseTemplates::from_line(EditStep step) const {
  return with_source(std::move(step), [&](const std::string& name) { return source_of(name); });
}

EditStep CaseTemplates::to_line(EditStep step) const {
  return with_source(std::move(step), [&](const std::string& source) { return name_of(source); });
}

}  // namespace homolog
