#pragma once

namespace homolog {

/// When a command is written to the log: see CommandLog.
enum class Logged {
  at_once,    ///< the rule
  when_done,  ///< its work goes on beside the window, and is given up where the case changes meanwhile
  never       ///< it leaves nothing behind, or comes down to another command, which is logged
};

}  // namespace homolog
