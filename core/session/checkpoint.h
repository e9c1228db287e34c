#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/case/document.h"

namespace homolog {

// A checkpoint is a line of a case file that holds the case as it is after the lines before it, so that these need not
// be played again to go on from there. It is never trusted over them: it says which version of Homolog wrote it, from
// which template and placement, and the checksum of the lines, and where one differs it is passed over. Taking the
// checkpoints out of a file changes nothing but the time that opening it takes.

/// The line, without its line feed. `lines_check`: of all lines before it. None where reading it would not give the
/// same document to the last bit.
std::optional<std::string> checkpoint_line(const Document& start, const Document& document, std::uint32_t lines_check);

/// The document that a line holds; none where it was made from another start, other lines or another version, or is
/// damaged.
std::optional<Document> read_checkpoint(const std::string& line, const Document& start, std::uint32_t lines_check);

/// Whether two documents of one start are the same to the last bit.
bool same_document(const Document& a, const Document& b);

}  // namespace homolog
