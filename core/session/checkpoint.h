#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/session/case_templates.h"
#include "core/session/same_document.h"

namespace homolog {

// A checkpoint is a line of a case file that holds the case as it is after the lines before it. Opening then needs not
// play those lines. The lines always count more than the checkpoint: it holds the number of its own format, what the
// solver gives on a small fixed problem, and checksums of the template, the placement and the lines. If one of these
// differs, or a member is missing, the checkpoint is ignored. Removing the checkpoints of a file changes only the time
// to open it.

/// The line, without its line feed. `lines_check`: of all lines before it. `templates`: those of structures that
/// `start` lacks. None where reading it would not give the same document to the last bit.
std::optional<std::string> checkpoint_line(const Document& start, const Document& document, std::uint32_t lines_check,
                                           const CaseTemplates& templates = {});

/// The document that a line holds; none where it was made from another start, other lines or another version, or is
/// damaged.
std::optional<Document> read_checkpoint(const std::string& line, const Document& start, std::uint32_t lines_check,
                                        const CaseTemplates& templates = {});

}  // namespace homolog
