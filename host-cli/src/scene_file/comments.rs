//! Changes the values in a TOML text and keeps its comments.

use toml::{Table, Value};
use toml_edit::{DocumentMut, Item, TableLike, TomlError};

/// The text with the values of the table `wanted`. Unchanged values keep their places and their comments.
pub fn with_values(text: &str, wanted: &Table) -> Result<String, TomlError> {
    let mut document: DocumentMut = text.parse()?;
    set_table(document.as_table_mut(), wanted)?;
    Ok(document.to_string())
}

fn set_table(own: &mut dyn TableLike, wanted: &Table) -> Result<(), TomlError> {
    let gone = own.iter().map(|(key, _)| key.to_owned()).filter(|key| !wanted.contains_key(key));
    for key in gone.collect::<Vec<_>>() {
        own.remove(&key);
    }
    for (key, value) in wanted {
        match own.get_mut(key) {
            Some(item) => set(item, value)?,
            None => drop(own.insert(key, Item::Value(written(value)?))),
        }
    }
    Ok(())
}

fn set(own: &mut Item, wanted: &Value) -> Result<(), TomlError> {
    match (own, wanted) {
        (Item::Table(own), Value::Table(wanted)) => set_table(own, wanted),
        (Item::Value(toml_edit::Value::InlineTable(own)), Value::Table(wanted)) => set_table(own, wanted),
        (Item::ArrayOfTables(own), Value::Array(wanted)) if own.len() == wanted.len() => {
            let wanted = wanted.iter().filter_map(Value::as_table);
            own.iter_mut().zip(wanted).try_for_each(|(own, wanted)| set_table(own, wanted))
        }
        (Item::Value(own), wanted) => set_value(own, wanted),
        (own, wanted) => {
            *own = Item::Value(written(wanted)?);
            Ok(())
        }
    }
}

fn set_value(own: &mut toml_edit::Value, wanted: &Value) -> Result<(), TomlError> {
    let is_same = toml::from_str::<Table>(&format!("value = {own}")).is_ok_and(|own| own.get("value") == Some(wanted));
    if !is_same {
        let around = own.decor().clone();
        *own = written(wanted)?;
        *own.decor_mut() = around;
    }
    Ok(())
}

/// The value as `toml_edit` parses it from its text.
fn written(value: &Value) -> Result<toml_edit::Value, TomlError> {
    value.to_string().parse()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_places_are_kept() {
        let given = "# A scene.\nduration = 2.0 # s\n\n[[cloth]] # the sheet\ngrid = [\n  8, # across\n  8,\n]\n\
                     stretch = { model = \"membrane\", weft = 2.0 } # stiff\nshear = 1.0 # goes\n\n\
                     # How it is run.\n[integrator]\nstep = 1e-2 # s\n";
        let mut wanted: Table = toml::from_str(given).unwrap();
        wanted.remove("duration");
        let cloth = wanted["cloth"][0].as_table_mut().unwrap();
        cloth.remove("shear");
        cloth["stretch"] = Value::Table(toml::from_str("model = \"spring\"").unwrap());
        wanted["integrator"] = Value::Table(toml::from_str("step = 0.005\nmethod = \"rk4\"").unwrap());
        let text = with_values(given, &wanted).unwrap();
        assert_eq!(toml::from_str::<Table>(&text).unwrap(), wanted, "{text}");
        for kept in ["[[cloth]] # the sheet", "8, # across", "# stiff", "# How it is run.", "step = 0.005 # s"] {
            assert!(text.contains(kept), "{kept:?} is not in {text}");
        }
        assert!(!text.contains("goes"), "{text}");
        assert_eq!(with_values(given, &toml::from_str(given).unwrap()).unwrap(), given);
    }
}
