document.getElementById("app")!.textContent = "Pliant";
