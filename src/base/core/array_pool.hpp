// Work space that is used again.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "base/core/aligned_array.hpp"

namespace pliant {

/// Lends arrays and keeps them when they come back: fresh ones cost a page fault every 4 KB. May be used from several
/// threads at once.
template <class T>
class ArrayPool {
public:
    ArrayPool() = default;
    /// A pool is no part of the value of what owns it: a moved one begins empty.
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

    /// Of at least this size; what is in it is anything.
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

    /// Gives back to the system what is not on loan.
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
