#include "core/session/case_templates.h"

#include <utility>

#include "core/base/paths.h"
#include "core/catalogue/catalogue.h"

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

}  // namespace

Result<std::shared_ptr<const Template>> CaseTemplates::load(const std::string& source) const {
  if (const auto found = known_->find(source); found != known_->end()) return found->second;
  auto read = load_template(source);
  if (!read) return fail(read.error());
  add(*read);
  return *read;
}

void CaseTemplates::add(std::shared_ptr<const Template> the_template) const {
  const std::string source = the_template->source;
  known_->insert_or_assign(source, std::move(the_template));
}

Result<void> CaseTemplates::complete(EditStep& step) const {
  auto* structure = std::get_if<SetStructure>(&step.action);
  if (structure == nullptr) return {};
  if (structure->the_template) {
    structure->source = structure->the_template->source;
    add(structure->the_template);
  }
  if (structure->source.empty() || structure->the_template) return {};
  auto read = load(structure->source);
  if (!read) return fail(read.error());
  structure->the_template = *read;
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
