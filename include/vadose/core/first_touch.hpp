// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include <vadose/core/parallel.hpp>

namespace vadose {

/// Makes room for `size` elements in a vector, which is empty then. Threads write to new room first, in
/// spans as they will work on it: where processors have memories of their own, each takes a part of the
/// array instead of that of one thread all of it.
template <class T, class Allocator>
void reserve_by_threads(std::vector<T, Allocator>& values, std::size_t size, int threads) {
  values.clear();
  if (size <= values.capacity()) return;  // has its place
  std::vector<T, Allocator>().swap(values);
  values.reserve(size);
  constexpr std::size_t page = 4096;  // [byte]
  auto* bytes = reinterpret_cast<volatile unsigned char*>(values.data());
  parallel_for(size * sizeof(T) / page, threads, [&](std::size_t i, int) { bytes[i * page] = 0; });
}

}  // namespace vadose
