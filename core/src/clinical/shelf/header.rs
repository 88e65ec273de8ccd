//! What the name of a column says: what the column holds, and its unit.

/// What a column of a table of sizes holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Nothing of a size.
    Ignored,
    /// The maker's reference or name.
    Name,
    /// Base width, or the diameter of a round base.
    Width,
    /// Height of the base along the body, of an anatomical implant.
    Height,
    /// Projection.
    Projection,
    /// Volume.
    Volume,
}

impl Column {
    /// All contents, in the order of a menu.
    pub const ALL: [Self; 6] =
        [Self::Name, Self::Width, Self::Height, Self::Projection, Self::Volume, Self::Ignored];

    /// The content in a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Ignored => "ignored",
            Self::Name => "name",
            Self::Width => "width",
            Self::Height => "height",
            Self::Projection => "projection",
            Self::Volume => "volume",
        }
    }

    /// Has the column lengths?
    #[must_use]
    pub fn is_length(self) -> bool {
        matches!(self, Self::Width | Self::Height | Self::Projection)
    }
}

/// The unit of lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
}

impl LengthUnit {
    /// The unit of a word.
    #[must_use]
    pub fn of(word: &str) -> Option<Self> {
        [Self::Mm, Self::Cm].into_iter().find(|unit| unit.word() == word)
    }

    /// The unit as it is written.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::Cm => "cm",
        }
    }

    /// mm of the unit.
    #[must_use]
    pub fn in_mm(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
        }
    }
}

/// What the name of a column says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meaning {
    pub(super) column: Column,
    /// Columns of a lower rank come first where two hold the same.
    pub(super) rank: u8,
    /// The unit of lengths, if it is named.
    pub(super) unit: Option<LengthUnit>,
    /// Is the width a diameter?
    pub(super) is_diameter: bool,
}

/// The rank from which on a name counts only if the column has numbers.
pub(super) const UNSURE: u8 = 5;

/// Is this a unit of volumes, folded?
pub(super) fn is_volume_unit(unit: &str) -> bool {
    ["ml", "cc", "ccm", "cm3"].contains(&unit)
}

const DIAMETERS: [&str; 7] =
    ["diameter", "diametro", "diametre", "durchmesser", "diam", "dia", "ø"];
const PROJECTIONS: [&str; 8] = [
    "projection",
    "proyeccion",
    "projektion",
    "proiezione",
    "projecao",
    "proieccion",
    "proj",
    "proy",
];
const HEIGHTS: [&str; 8] =
    ["height", "hohe", "hoehe", "altura", "hauteur", "altezza", "alto", "ht"];
const WIDTHS: [&str; 8] =
    ["width", "breite", "anchura", "ancho", "largeur", "larghezza", "largura", "anch"];
const BASES: [&str; 3] = ["base", "basis", "breit"];
const VOLUMES: [&str; 6] = ["volume", "volumen", "volumes", "volumina", "volum", "vol"];
const PROFILES: [&str; 4] = ["profile", "profil", "perfil", "profilo"];
const REFERENCES: [&str; 22] = [
    "ref",
    "refs",
    "reference",
    "referencia",
    "referenz",
    "riferimento",
    "cat",
    "catalog",
    "catalogue",
    "catalogo",
    "article",
    "artikel",
    "artikelnummer",
    "articulo",
    "articolo",
    "artigo",
    "bestellnummer",
    "codigo",
    "code",
    "codice",
    "sku",
    "cod",
];
const NAMES: [&str; 17] = [
    "name",
    "nombre",
    "nom",
    "nome",
    "bezeichnung",
    "denominacion",
    "designation",
    "model",
    "modelo",
    "modele",
    "modell",
    "modello",
    "product",
    "producto",
    "produkt",
    "produit",
    "prodotto",
];
const SIZES: [&str; 8] =
    ["size", "item", "taille", "talla", "tamano", "grosse", "misura", "implant"];
/// The letters of makers' drawings.
const LETTERS: [(&str, Column); 4] =
    [("w", Column::Width), ("h", Column::Height), ("p", Column::Projection), ("v", Column::Volume)];

/// What a name of a column says; `None` for another name.
pub(super) fn meaning(title: &str) -> Option<Meaning> {
    let words = words(title);
    let is_one_of =
        |known: &[&str]| words.iter().any(|word| known.iter().any(|known| is_word(word, known)));
    let unit = words.iter().find_map(|word| LengthUnit::of(word));
    let has_volume_unit = words.iter().any(|word| is_volume_unit(word));
    let letter = || {
        let [first, rest @ ..] = words.as_slice() else { return None };
        let is_unit = |word: &String| LengthUnit::of(word).is_some() || is_volume_unit(word);
        let (_, column) = LETTERS.iter().find(|(letter, _)| letter == first)?;
        rest.iter().all(is_unit).then_some(*column)
    };
    let is_diameter = is_one_of(&DIAMETERS);
    let (column, rank) = if is_diameter {
        (Column::Width, 0)
    } else if is_one_of(&PROJECTIONS) {
        (Column::Projection, 0)
    } else if is_one_of(&HEIGHTS) {
        (Column::Height, 0)
    } else if is_one_of(&WIDTHS) {
        (Column::Width, u8::from(!is_one_of(&BASES)))
    } else if is_one_of(&VOLUMES) {
        (Column::Volume, 0)
    } else if is_one_of(&PROFILES) {
        (Column::Projection, UNSURE)
    } else if is_one_of(&BASES) {
        (Column::Width, 2)
    } else if has_volume_unit {
        (Column::Volume, 1)
    } else if unit.is_none() && is_one_of(&REFERENCES) {
        (Column::Name, 0)
    } else if unit.is_none() && is_one_of(&NAMES) {
        (Column::Name, 1)
    } else if unit.is_none() && is_one_of(&SIZES) {
        (Column::Name, 2)
    } else {
        (letter()?, UNSURE)
    };
    let unit = unit.filter(|_| column.is_length());
    // "Volume (mm)" is no volume.
    let is_wrong = column == Column::Volume && words.iter().any(|word| word == "mm")
        || column.is_length() && unit.is_none() && has_volume_unit;
    (!is_wrong).then_some(Meaning { column, rank, unit, is_diameter })
}

/// Is a word the known one, or composed with it, as "Implantatbreite"?
fn is_word(word: &str, known: &str) -> bool {
    const COMPOSED: [&str; 7] =
        ["breite", "hohe", "hoehe", "volumen", "durchmesser", "projektion", "nummer"];
    word == known || COMPOSED.contains(&known) && word.ends_with(known)
}

/// The words of a name in small letters without accents; Ø stands alone.
fn words(title: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for letter in title.chars().flat_map(char::to_lowercase) {
        let Some(word) = words.last_mut() else { break };
        match letter {
            'ø' | '⌀' | '∅' => words.extend(["ø".to_owned(), String::new()]),
            '\u{300}'..='\u{36f}' => {}
            letter if letter.is_alphanumeric() => word.push(plain(letter)),
            _ => words.push(String::new()),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// A unit in small letters, as "cm3" of "cm³".
pub(super) fn unit_word(unit: &str) -> String {
    words(unit).concat()
}

/// A small letter without its accent.
fn plain(letter: char) -> char {
    match letter {
        'á' | 'à' | 'â' | 'ä' | 'ã' | 'å' => 'a',
        'é' | 'è' | 'ê' | 'ë' => 'e',
        'í' | 'ì' | 'î' | 'ï' => 'i',
        'ó' | 'ò' | 'ô' | 'ö' | 'õ' => 'o',
        'ú' | 'ù' | 'û' | 'ü' => 'u',
        'ñ' => 'n',
        'ç' => 'c',
        '³' => '3',
        letter => letter,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_makers_in_six_languages_are_understood() {
        use Column::{Height, Name, Projection, Volume, Width};
        let (mm, cm) = (Some(LengthUnit::Mm), Some(LengthUnit::Cm));
        for (column, unit, titles) in [
            (
                Name,
                None,
                &[
                    "Ref.",
                    "Reference",
                    "Cat. No.",
                    "Article",
                    "Art.-Nr. / Artikel",
                    "Bestellnummer",
                    "Referencia",
                    "Référence",
                    "Código",
                    "Codice",
                    "name",
                    "Modèle",
                    "Size",
                ][..],
            ),
            (Width, cm, &["Breite (cm)", "Anchura cm", "width_cm", "Base Width [cm]"]),
            (Width, mm, &["Diameter, mm", "Ø (mm)", "Ømm", "Durchmesser in mm", "Diamètre (mm)"]),
            (Width, None, &["Base", "Largeur", "Larghezza base", "Implantatbreite", "⌀"]),
            (Projection, cm, &["Projection (cm)", "Proyección (cm)", "Base projection\n(cm)"]),
            (
                Projection,
                None,
                &["Projektion", "Proiezione", "Projec\u{327}a\u{303}o", "Profil", "P"],
            ),
            (Height, None, &["Höhe", "Hohe", "Altura", "Hauteur", "Base height", "Altezza"]),
            (Volume, None, &["Volumen", "Vol. (cc)", "Volume cm³", "Füllvolumen (ml)", "ml", "CC"]),
        ] {
            for title in titles {
                let found = meaning(title).map(|found| (found.column, found.unit));
                assert_eq!(found, Some((column, unit)), "{title}");
            }
        }
        for title in
            ["", "Price", "Weight (g)", "Volume (mm)", "Size (cm)", "Width (cc)", "Gewicht", "A"]
        {
            assert_eq!(meaning(title), None, "{title}");
        }
        assert!(meaning("Ø base (cm)").unwrap().is_diameter);
    }
}
