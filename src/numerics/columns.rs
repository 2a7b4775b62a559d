//! A batch of points, one column a coordinate: the shape in which samples travel.

/// A table of `f64`, `rows` × `columns`, stored column after column.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Columns {
    rows: usize,
    columns: usize,
    data: Vec<f64>,
}

impl Columns {
    /// A table of zeros.
    pub fn new(rows: usize, columns: usize) -> Self {
        Columns { rows, columns, data: vec![0.0; rows * columns] }
    }

    /// A table from its rows, each of the same length.
    ///
    /// # Panics
    /// If a row's length differs from the first one's: a mistake of the caller's, not of an input.
    pub fn from_rows<R: AsRef<[f64]>>(rows: &[R]) -> Self {
        let columns = rows.first().map_or(0, |row| row.as_ref().len());
        let mut table = Columns::new(rows.len(), columns);
        for (k, row) in rows.iter().enumerate() {
            assert_eq!(row.as_ref().len(), columns, "row {k} has another length");
            for (j, &value) in row.as_ref().iter().enumerate() {
                table.column_mut(j)[k] = value;
            }
        }
        table
    }

    /// The rows of tables of `columns` coordinates, one table after the other.
    pub fn joined<'a>(columns: usize, parts: impl Iterator<Item = &'a Columns> + Clone) -> Self {
        let rows = parts.clone().map(Columns::rows).sum();
        let mut data = Vec::with_capacity(rows * columns);
        for j in 0..columns {
            for part in parts.clone() {
                data.extend_from_slice(part.column(j));
            }
        }
        Columns { rows, columns, data }
    }

    /// Number of rows: points.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns: coordinates.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Points `first` to `first + rows − 1`, as a table of their own.
    ///
    /// # Panics
    /// If there are not that many: a mistake of the caller's, not of an input.
    pub fn rows_from(&self, first: usize, rows: usize) -> Columns {
        let mut part = Vec::with_capacity(rows * self.columns);
        for j in 0..self.columns {
            part.extend_from_slice(&self.column(j)[first..first + rows]);
        }
        Columns { rows, columns: self.columns, data: part }
    }

    /// Coordinate `j` of every point.
    pub fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Coordinate `j` of every point, to be written.
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Coordinate `j` of point `k`.
    pub fn get(&self, k: usize, j: usize) -> f64 {
        self.data[j * self.rows + k]
    }

    /// Sets coordinate `j` of point `k`.
    pub fn set(&mut self, k: usize, j: usize, value: f64) {
        self.data[j * self.rows + k] = value;
    }

    /// Point `k`, gathered.
    pub fn row(&self, k: usize) -> Vec<f64> {
        (0..self.columns).map(|j| self.get(k, j)).collect()
    }

    /// Gives the table another shape, all zeros, keeping its memory.
    pub fn reset(&mut self, rows: usize, columns: usize) {
        self.data.clear();
        self.reshape(rows, columns);
    }

    /// Gives the table another shape, keeping its memory; its values are the caller's to write, all of them.
    pub fn reshape(&mut self, rows: usize, columns: usize) {
        self.rows = rows;
        self.columns = columns;
        self.data.resize(rows * columns, 0.0);
    }
}
