#pragma once

#include <doctest/doctest.h>

#include "core/base/result.h"

namespace homolog::test {

/// The value, or a failure of the test with the error's sentence.
template <class T>
T must(Result<T> result) {
  if (!result) FAIL(result.error().sentence());
  return std::move(*result);
}

}  // namespace homolog::test
