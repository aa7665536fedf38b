// Read-only numpy arrays over numbers of the library, which they keep alive.
#pragma once

#include <pybind11/numpy.h>

#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pliant/base.hpp"

namespace pliant::python {

namespace py = pybind11;
using Shape = std::vector<py::ssize_t>;

inline void forbid_writing(py::array& array) {
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
}

template <class Owner>
py::capsule keep(Owner owner) {
    return {new Owner(std::move(owner)), [](void* pointer) { delete static_cast<Owner*>(pointer); }};
}

/// An array over numbers that belong to `owner`, of which a copy is kept.
template <class T, class Owner>
py::array view(const T* numbers, Shape shape, Owner owner) {
    py::array_t<T> array(std::move(shape), numbers, keep(std::move(owner)));
    forbid_writing(array);
    return array;
}

/// An array that takes over the vector.
template <class T>
py::array array_of(std::vector<T> numbers) {
    auto* const kept = new std::vector<T>(std::move(numbers));
    const py::capsule owner(kept, [](void* pointer) { delete static_cast<std::vector<T>*>(pointer); });
    return py::array_t<T>(static_cast<py::ssize_t>(kept->size()), kept->data(), owner);
}
/// (n, K)
template <class T, std::size_t K>
py::array array_of(std::vector<std::array<T, K>> rows) {
    auto* const kept = new std::vector<std::array<T, K>>(std::move(rows));
    const py::capsule owner(kept, [](void* pointer) { delete static_cast<std::vector<std::array<T, K>>*>(pointer); });
    const T* const first = kept->empty() ? nullptr : kept->front().data();
    return py::array_t<T>(Shape{static_cast<py::ssize_t>(kept->size()), static_cast<py::ssize_t>(K)}, first, owner);
}
inline py::array array_of(const Point& point) {
    return py::array_t<double>(3, point.data());
}

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Indices = py::array_t<int, py::array::c_style | py::array::forcecast>;

inline std::span<const double> span_of(const Numbers& numbers) {
    return {numbers.data(), static_cast<std::size_t>(numbers.size())};
}
/// (n, 3) or (3 n).
inline std::vector<Point> points_of(const Numbers& numbers) {
    if (numbers.size() % 3 != 0) throw Failure(Failure::Kind::input, "points have three coordinates each");
    std::vector<Point> points(static_cast<std::size_t>(numbers.size()) / 3);
    const double* at = numbers.data();
    for (Point& p : points) {
        p = {at[0], at[1], at[2]};
        at += 3;
    }
    return points;
}

}  // namespace pliant::python
