// Reusable work space.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "base/core/aligned_array.hpp"

namespace pliant {

/// Lends arrays and keeps them when they are returned: a fresh array costs a page fault every 4 KB. Thread-safe.
template <class T>
class ArrayPool {
public:
    ArrayPool() = default;
    /// The pool is not part of its owner's value: after a move the new pool is empty.
    ArrayPool(ArrayPool&&) noexcept {}
    ArrayPool& operator=(ArrayPool&&) noexcept { return *this; }

    class Loan {
    public:
        Loan(ArrayPool& pool, AlignedArray<T> array) : pool_(&pool), array_(std::move(array)) {}
        Loan(const Loan&) = delete;
        Loan& operator=(const Loan&) = delete;
        ~Loan() { pool_->take_back(std::move(array_)); }
        [[nodiscard]] T* data() const { return array_.data(); }

    private:
        ArrayPool* pool_;
        AlignedArray<T> array_;
    };

    /// An array of at least this size, with unspecified contents.
    [[nodiscard]] Loan lend(std::size_t size) {
        AlignedArray<T> array;
        {
            const std::lock_guard lock(mutex_);
            for (AlignedArray<T>& kept : kept_) {
                if (kept.size() < size || size == 0) continue;
                array = std::move(kept);
                std::swap(kept, kept_.back());
                kept_.pop_back();
                break;
            }
        }
        if (array.size() < size) array.resize(size);
        return Loan(*this, std::move(array));
    }

    /// Frees all arrays that are not on loan.
    void clear() {
        const std::lock_guard lock(mutex_);
        kept_.clear();
    }

private:
    void take_back(AlignedArray<T> array) {
        if (array.size() == 0) return;
        const std::lock_guard lock(mutex_);
        kept_.push_back(std::move(array));
    }

    std::mutex mutex_;
    std::vector<AlignedArray<T>> kept_;
};

}  // namespace pliant
