#include "core/solve/ordering.h"

#include <metis.h>

#include <mutex>
#include <new>
#include <stdexcept>
#include <type_traits>

#include "core/base/processes/signal_handlers.h"
#include "core/base/processes/system_modules.h"

namespace homolog {

namespace {

/// METIS seeds the C library's rand() and draws from it. A process has one rand(), and graphics drivers and libraries
/// draw from it too, on threads of their own: an order would depend on what they do meanwhile. So METIS gets a C
/// library of its own. Under a sanitizer, which allows none, it uses that of the process. Throws std::runtime_error
/// where the system makes none.
decltype(&METIS_NodeND) node_nd() {
#ifdef HOMOLOG_SANITIZED
  return &METIS_NodeND;
#else
  static const auto own = reinterpret_cast<decltype(&METIS_NodeND)>(
      in_namespace_of_its_own(reinterpret_cast<const void*>(&METIS_NodeND), "METIS_NodeND"));
  if (own == nullptr)
    throw std::runtime_error(
        "METIS cannot be loaded a second time (dlmopen), without which the same input would not give the same results; "
        "run the program with the shared library of METIS, as its packages have it");
  return own;
#endif
}

}  // namespace

Ordering nested_dissection(SparsityGraph graph) {
  static_assert(std::is_same_v<idx_t, int>);
  // While METIS works it catches SIGABRT and SIGTERM for the whole process. Two at a time put back the wrong handlers,
  // and one puts them back without their flags.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const KeptSignalHandlers kept;
  const std::size_t n = graph.start.size() - 1;
  Ordering ordering{std::vector<int>(n), std::vector<int>(n)};
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NITER] = 1;  // a fifth faster than its ten rounds of refinement; L is up to 2 % larger
  int unknowns = static_cast<int>(n);
  const int status = node_nd()(&unknowns, graph.start.data(), graph.neighbour.data(), nullptr, options,
                               ordering.order.data(), ordering.position.data());
  if (status == METIS_ERROR_MEMORY) throw std::bad_alloc();
  if (status != METIS_OK) throw std::runtime_error("METIS could not order the unknowns of a mesh");
  return ordering;
}

}  // namespace homolog
