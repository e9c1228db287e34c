#pragma once

#include "app/verbs/verb.h"

namespace homolog {

/// Puts the program that runs into the user's menu, without root: menu entry, icon, file types and thumbnails go into
/// $XDG_DATA_HOME (~/.local/share), with a record of what was written. Once more does no harm. A program that a package
/// put into the menu is left as it is. Report: `already`, or `program`, `written` and `updated` (the system's tools
/// that brought their caches up to date). Errors: a file of another is in the way; the folder cannot be written.
/// [Desktop Entry Specification 1.5; Shared MIME-info 0.21]
Result<Report> integrate_desktop();

/// Takes away what integrate_desktop() wrote, and the folders that it made, if they are empty. A file that was changed
/// since stays, with a warning. Report: `removed`, `updated`. Errors: the system refuses.
Result<Report> leave_desktop();

}  // namespace homolog
