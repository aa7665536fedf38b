// Arrays in numpy's format.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace pliant::study {

/// A .npy file, version 1.0 of the format (NumPy Enhancement Proposal 1): a one-dimensional array of numbers, booleans
/// or texts. Texts are UTF-8; invalid bytes are replaced. Each takes as much room as the longest, hence `most_letters`:
/// the rest of a text is left out.
[[nodiscard]] std::string npy_numbers(std::span<const double> numbers);
[[nodiscard]] std::string npy_truths(const std::vector<bool>& truths);
[[nodiscard]] std::string npy_texts(std::span<const std::string> texts,
                                    std::size_t most_letters = std::numeric_limits<std::size_t>::max());

}  // namespace pliant::study
