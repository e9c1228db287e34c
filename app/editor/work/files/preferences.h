#pragma once

#include <filesystem>

#include "app/editor/state/state.h"

namespace homolog {

/// $XDG_CONFIG_HOME/homolog/editor.json, else ~/.config/homolog/editor.json.
std::filesystem::path preferences_file();
/// The preferences that were kept; the defaults where the file is absent, and for every entry that it does not hold.
Preferences read_preferences(const std::filesystem::path& path);
Result<void> write_preferences(const Preferences& preferences, const std::filesystem::path& path);

}  // namespace homolog
