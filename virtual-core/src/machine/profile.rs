//! Cost by function.

use crate::cycle::Cost;
use crate::image::{Image, Symbol};

/// Cost of a function by itself, without the functions that it called.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FunctionCost {
    /// Demangled name; `(no symbol)` gathers all code without a symbol.
    pub name: String,
    /// First address; 0 for `(no symbol)`.
    pub address: u32,
    /// Cost of the function's own instructions.
    pub cost: Cost,
}

/// Addresses of a function. Of symbols that share an address the first one names it.
#[derive(Debug)]
struct Function {
    name: String,
    start: u32,
    end: u32,
}

/// Functions of an image in the order of their addresses, and the cost of each.
#[derive(Debug)]
pub(super) struct Functions {
    sorted: Vec<Function>,
    /// Costs by index: index 0 is code without a symbol, and index `n + 1` is `sorted[n]`.
    costs: Vec<Cost>,
    /// Index of the function that is charged.
    current: u16,
    /// Total cost of the machine when `current` was entered.
    since: Cost,
}

impl Functions {
    /// Returns the functions of an image, without costs.
    pub(super) fn of(image: &Image) -> Functions {
        let mut sorted: Vec<Function> = Vec::new();
        for symbol in image.symbols().iter().filter(|symbol| symbol.is_function) {
            let Symbol { name, address: start, bytes, .. } = symbol.clone();
            if sorted.last().is_none_or(|last| last.start != start) && sorted.len() < usize::from(u16::MAX) - 1 {
                sorted.push(Function { name, start, end: start.saturating_add(bytes) });
            }
        }
        let costs = vec![Cost::default(); sorted.len() + 1];
        Functions { sorted, costs, current: 0, since: Cost::default() }
    }

    /// Returns the index of the function that contains `address`, 0 if none does.
    pub(super) fn index_at(&self, address: u32) -> u16 {
        let next = self.sorted.partition_point(|function| function.start <= address);
        let inside = next.checked_sub(1).is_some_and(|index| address < self.sorted[index].end);
        if inside { next as u16 } else { 0 }
    }

    /// Returns the name of the function that contains `address`.
    pub(super) fn name_at(&self, address: u32) -> String {
        self.name(usize::from(self.index_at(address)))
    }

    fn name(&self, index: usize) -> String {
        let function = index.checked_sub(1).and_then(|index| self.sorted.get(index));
        function.map_or_else(|| "(no symbol)".to_owned(), |function| function.name.clone())
    }

    /// Returns true if the function of index `function` is charged.
    #[inline]
    pub(super) fn is_current(&self, function: u16) -> bool {
        self.current == function
    }

    /// Charges the function of index `function` from now on; `total` is the machine's total cost.
    pub(super) fn enter(&mut self, function: u16, total: Cost) {
        self.costs[usize::from(self.current)] += total - self.since;
        self.current = function;
        self.since = total;
    }

    /// Returns the cost of every function that ran, the dearest first, by nominal cycles.
    pub(super) fn profile(&self, total: Cost) -> Vec<FunctionCost> {
        let mut profile: Vec<FunctionCost> = (0..self.costs.len())
            .map(|index| {
                let running = if index == usize::from(self.current) { total - self.since } else { Cost::default() };
                let address = index.checked_sub(1).map_or(0, |index| self.sorted[index].start);
                FunctionCost { name: self.name(index), address, cost: self.costs[index] + running }
            })
            .filter(|function| function.cost.instructions != 0)
            .collect();
        profile.sort_by(|a, b| (b.cost.nominal, a.address).cmp(&(a.cost.nominal, b.address)));
        profile
    }

    /// Sets all costs to 0; `total` is the machine's total cost.
    pub(super) fn clear(&mut self, total: Cost) {
        self.costs.fill(Cost::default());
        self.since = total;
    }
}
