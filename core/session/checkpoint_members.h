#pragma once

#include "core/base/encoding/json.h"
#include "core/session/case_templates.h"

namespace homolog {

// The members of a document as JSON, as a checkpoint keeps them [checkpoint.h].

/// Thrown, as the JSON library throws: what is read is no checkpoint of this case, or a document cannot be kept in one.
struct Unusable {};

/// The members of a document that a checkpoint keeps [members.h]. `start`: the document that the case begins with.
/// `templates`: those of structures that it lacks. Throws: Unusable.
nlohmann::ordered_json members_to_json(const Document& start, const Document& document, const CaseTemplates& templates);

/// The document of such members. Throws: Unusable, Unreadable, exceptions of the JSON library.
Document members_from_json(const nlohmann::ordered_json& json, const Document& start, const CaseTemplates& templates);

}  // namespace homolog
