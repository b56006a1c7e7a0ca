// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace elastocal {

/// An array of NumPy: numbers or texts, row by row; or records, as an array for each of their
/// fields.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> numbers;
  std::vector<std::string> texts;
  bool is_text = false;
  std::string unit;  ///< unit of times (datetime64, timedelta64): "s", "ns"; empty: none is stated
  std::vector<std::string> field_names;  ///< for an array of records: names of the fields
  std::vector<NpyArray> fields;          ///< its fields; shape: the array's, then the field's

  std::size_t count() const;
};

/// Reads the next bytes into `to`; returns how many there were.
using ReadBytes = std::function<std::size_t(std::span<char> to)>;

/// Reads an array in NumPy's format (.npy): floats of 4 and 8 bytes, integers, booleans, texts,
/// times; either byte order, rows or columns first; lists of records of these. Throws InputError,
/// whose message begins with `place`: another kind of data (objects), a shape that the bytes do not
/// hold, more than 2^27 numbers. If `wanted` is given and the array has another shape, only the
/// shape and the names of fields are read.
NpyArray ReadNpy(const ReadBytes& read, const std::string& place,
                 const std::vector<std::size_t>* wanted = nullptr);

}  // namespace elastocal
