//! What was found and what is expected, as rows of a table.

/// The rows of one oracle: printed together, and the test fails when any of them is off.
pub struct Oracle {
    name: &'static str,
    rows: Vec<String>,
    off: Vec<String>,
}

impl Oracle {
    pub fn new(name: &'static str) -> Self {
        Self { name, rows: Vec::new(), off: Vec::new() }
    }

    /// A relative error.
    pub fn close(&mut self, quantity: &str, found: f64, expected: f64, tolerance: f64) {
        self.row(quantity, found, expected, found / expected - 1.0, tolerance);
    }

    /// A distance to the nearer of two values between which several programs differ, relative to it.
    pub fn between(&mut self, quantity: &str, found: f64, one: f64, other: f64, tolerance: f64) {
        let quantity = format!("{quantity} ({one:.5} to {other:.5})");
        self.close(&quantity, found, found.clamp(one.min(other), one.max(other)), tolerance);
    }

    /// An absolute error, in the unit of the quantity.
    pub fn within(&mut self, quantity: &str, found: f64, expected: f64, allowed: f64) {
        self.row(quantity, found, expected, found - expected, allowed);
    }

    fn row(&mut self, quantity: &str, found: f64, expected: f64, error: f64, allowed: f64) {
        // Not-a-number is off, too.
        let right = error.abs() <= allowed;
        let mark = if right { "" } else { " OFF" };
        let name = self.name;
        let row = format!(
            "| {name:<25} | {quantity:<60} | {found:>13.6e} | {expected:>13.6e} | {error:>9.1e} | {allowed:>7.0e} |{mark}"
        );
        if !right {
            self.off.push(row.clone());
        }
        self.rows.push(row);
    }
}

impl Drop for Oracle {
    fn drop(&mut self) {
        println!("{}", self.rows.join("\n"));
        if !std::thread::panicking() {
            assert!(self.off.is_empty(), "\n{}", self.off.join("\n"));
        }
    }
}
