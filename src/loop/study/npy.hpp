// Arrays in numpy's format.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace pliant::study {

/// A .npy file, version 1.0 of the format (NumPy Enhancement Proposal 1): a one-dimensional array of numbers, booleans
/// or texts. Texts are UTF-8; invalid bytes are replaced.
[[nodiscard]] std::string npy_numbers(std::span<const double> numbers);
[[nodiscard]] std::string npy_truths(const std::vector<bool>& truths);
[[nodiscard]] std::string npy_texts(std::span<const std::string> texts);

}  // namespace pliant::study
